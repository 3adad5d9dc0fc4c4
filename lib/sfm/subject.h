#ifndef SFM_SUBJECT_H
#define SFM_SUBJECT_H
#include "sfm/head/head.h"

#define SUBJECT "work/subject.ply"

/* True where the folder holds a mesh of the person. */
bool subject_given(struct stage *stage);

/* The mesh of the subject, mm in the head's frame: cloud, COLMAP's Poisson mesher, cleaned, coloured. */
bool subject_make(const struct head *head, const struct views *views, struct stage *stage, const struct calibrate_options *o,
                  const char *made_by, struct err *err);

#endif
