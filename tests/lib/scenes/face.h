/* face: a made face for the skin column: a sheet of skin with two fissures, draped over two eyeballs with corneas, and a
 * model of its motion whose truth is known. Frame: the head's, mm; both subject and character.
 */
#ifndef TESTS_FACE_H
#define TESTS_FACE_H
#include "mesh/mesh.h"
#include "model/model.h"
#include "rig/make/make.h"

struct face {
	struct mesh skin;              // the subject: the sheet alone
	struct mesh character;         // sheet, then left and right eyeball
	struct skin_model model;
	int32_t *b_start, *b_column;   // B of the character: the sheet's vertices are the subject's
	double *b_weight;
	double center[2][3], radius;
};

/* flat: the sheet is the plane z = 12 and no fissure is cut; the globes lie 100 mm behind it. */
void face_make(struct face *face, bool flat);
void face_free(struct face *face);

/* Sensible settings of extrapolate, and the character as rig_make wants it. */
struct rig_conf face_conf(void);
struct rig_character face_character(const struct face *face);

/* The character's rig, moved as the model says. As rig_make; report may be null. */
bool face_rig(struct rig *rig, struct rig_report *report, const struct face *face, const struct rig_conf *conf, struct err *err);

#endif
