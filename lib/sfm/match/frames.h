/* sfm_frames: selects frames of a video that cover what the camera saw.
 */
#ifndef SFM_MATCH_FRAMES_H
#define SFM_MATCH_FRAMES_H

/* Cuts n frames into at most `want` stretches of equal change and selects the sharpest frame of each.
 * chosen     out: [want], indices, rising
 * sharpness  [n]; change: [n], from the frame before, grey levels
 * same       grey levels: there are no more stretches than the whole change holds steps of this size
 * Returns how many frames are selected. */
int sfm_choose_frames(long *chosen, int want, long n, const double *sharpness, const double *change, double same);

#endif
