/* record: what was measured in one photograph, kept as work/limbus/NAME.edge.json, so that the poses of all photographs of an eye
 * can be fitted again without measuring again.
 */
#ifndef LIMBUS_RECORD_H
#define LIMBUS_RECORD_H
#include "limbus/find.h"
#include "limbus/pose.h"

struct limbus_record {
	bool ok, by_hand;              // by_hand: where a person said it is (hand.h)
	double rough;                  // refused, but known to this share of the semi-axis, with all that an ok one has; 0: to none. The stage may use it: ok, then
	char reason[256];
	int width, height;             // px
	struct pose_view view;         // camera as used
	double coverage, share_used, rms, blur, contrast;
	double gross;                  // chance of being more than LIMBUS_RIGHT off; 1 where nothing was found
	bool has_guess, has_rival;     // the likeliest ellipse, refused or not, and its best rival
	struct ellipse guess, rival;
	double point[ARCS][2];         // edge points, px
	enum { ARC_HIDDEN, ARC_SEEN, ARC_USED } state[ARCS];
};

/* Fills everything but the camera and the lean (measure.h). */
void limbus_record_fill(struct limbus_record *record, const struct limbus_found *found, const struct photo *photo);

/* Writes a record beside `path`, then renames it. False, err set, when it cannot. */
bool limbus_record_save(const struct limbus_record *record, const char *path, const char *made_by, struct err *err);
/* Reads one; record is overwritten. False, err set ("path: key: rule"), for a file that is none. */
bool limbus_record_load(struct limbus_record *record, const char *path, struct err *err);

#endif
