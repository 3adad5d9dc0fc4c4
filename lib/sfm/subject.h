/* subject: the person's mesh from the pictures.
 */
#ifndef SFM_SUBJECT_H
#define SFM_SUBJECT_H
#include "sfm/head/head.h"

#define SUBJECT "work/subject.ply"

/* True where the capture folder holds a mesh of the person: subject.ply or subject.obj. */
bool subject_given(struct stage *stage);

/* Makes work/subject.ply, mm in the head's frame: dense cloud, COLMAP's Poisson mesher, the largest connected part, the template
 * laid onto it where one is given, decimation, colours from the pictures.
 * With too few points for a mesh (mesh_min_points) it is recorded as skipped and an older file is removed. Returns false, err set,
 * when a program or a file fails. */
bool subject_make(const struct head *head, const struct views *views, struct stage *stage, const struct calibrate_options *o,
                  const char *made_by, struct err *err);

#endif
