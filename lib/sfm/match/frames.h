/* sfm_frames: which frames of a video say most of what the camera saw. */
#ifndef SFM_MATCH_FRAMES_H
#define SFM_MATCH_FRAMES_H

/* Which of n frames, each with its sharpness and its change from the one before (grey levels), to take: `want` stretches of
 * equal change, the sharpest of each. chosen[want] rising; returns how many. Frames of no change to speak of (below `same`)
 * lie in one stretch. */
int sfm_choose_frames(long *chosen, int want, long n, const double *sharpness, const double *change, double same);

#endif
