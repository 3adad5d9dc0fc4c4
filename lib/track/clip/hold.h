/* hold: the head held by its eyes, in a clip without a mesh. The average face that skin is followed on is not the person's, one who talks moves all of it, and in a small picture few
 * pixels show it; but the corners of the eyes, which the evidence of the pixels tells in each frame (eye/told.h), lie where the eyeballs are. They tell the head's place in the
 * picture, its lean and how near it is, all against the reference's pose; how it is turned the face does (head/turn.h).
 */
#ifndef TRACK_CLIP_HOLD_H
#define TRACK_CLIP_HOLD_H
#include "base/pack.h"
#include "track/clip/clip.h"
#include "track/eye/told.h"
#include "track/head/turn.h"

struct hold;

/* clip and subject are borrowed until hold_free, which accepts null. large_px: radius of irises from which they are large: the clip tells the eyeballs of those, and skin is believed. */
struct hold *hold_new(const struct track_clip *clip, const struct track_subject *subject, double large_px);
void hold_free(struct hold *hold);

/* On the way: skin's pose of a frame where irises are large and it has the eyes about where they were told last, or else the pose that they tell. */
void hold_guess(double pose[4][4], const struct hold *hold, const double skin_pose[4][4]);

/* On the way from one frame to the next: the face round the eyes is looked for near where it was in the frame kept; what was told last moves with it. Then the frame is kept. */
void hold_carry(struct hold *hold, const uint8_t *luma, int stride);
void hold_keep(struct hold *hold, const uint8_t *luma, int stride);

/* Whether eyes have not been told for longer than most blinks last, or ever but in the reference; where they were found then: middles of the irises, px; null: nowhere. These
 * tell lean and distance, too. */
bool hold_lost(const struct hold *hold);
void hold_found(struct hold *hold, const double eye[SIDES][2]);

/* Keeps what was told of a frame's eyes (null: nothing of that one) and of how its head is turned (null: nothing). radius: of the irises, px. dt: seconds since the frame before. keep: false of the reference, which
 * is looked at first. */
void hold_push(struct hold *hold, const struct eye_told *const told[SIDES], const struct head_turn *turn, double radius, double dt, bool keep);

/* Standard deviations of what is not known of the head in a frame. */
struct hold_known {
	double place_mm;
	double turn[TURNS];    // radians
};

/* After the last frame: sets poses[n], those of the frames kept; of a head on a rest, all to one. */
void hold_settle(struct hold_known *known, double (*poses)[4][4], long n, const struct hold *hold, bool rests);

/* After the last frame, where skin tells the path: poses[n], those of the frames kept, are turned about the middle between the eyes, all by the same, as faces look in the median. */
void hold_turn(double (*poses)[4][4], long n, const struct hold *hold);

/* How unlike a face it is that was looked at, in the median (head_turn's); NAN where it was in few frames. */
double hold_unlike(const struct hold *hold);

/* How much of an error in how the head is turned gaze has: eyes are held by their corners, which lie before the eyeballs' centres, so that part of it moves these. */
double hold_turn_share(const struct track_subject *subject);

/* Whether irises are large in the last frame. */
bool hold_large(const struct hold *hold);

void hold_pack(struct pack *pack, struct hold *hold, long first);

#endif
