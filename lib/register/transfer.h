/* transfer: a character laid onto the subject, and what of the subject's skin each of its vertices follows (skin paper,
 * section 3.6, equation 3.4).
 */
#ifndef REGISTER_TRANSFER_H
#define REGISTER_TRANSFER_H
#include "register/nricp/nricp.h"
#include "register/nricp/align.h"

struct transfer_conf {
	struct nricp_conf nricp;
	struct nricp_align_conf align;
	double least_piece;      // share of the largest piece's area below which a piece is carried along, not matched
	double open;             // faces with less before them free (mesh_openness) are carried along too
	double snap;             // distance from the subject at which a vertex's confidence has fallen to 1/e; share of its size
};

/* Everything of the character's vertices, in its mesh's order; owned. */
struct transfer {
	int n;
	float (*registered)[3];        // in the subject's unit and axes
	int32_t (*column)[3];          // rows of the subject mesh, rising; B has three entries a row
	double (*weight)[3];           // >= 0, sum 1
	int32_t *face;                 // of the subject mesh, onto which it is snapped; -1: a vertex of no face, of the same topology
	float (*bary)[3];              // weights of that face's corners
	float *distance, *confidence;  // in the subject's unit, from there; 0..1
	double subject_from_target[4][4];
	double scale, matched, rms, covered;
	bool same_topology;            // vertex i is vertex i of the subject: nothing was registered
};

/* Both meshes in mm. landmarks may be null. False, err set, when they have nothing in common. */
bool transfer_run(struct transfer *out, const struct mesh *target, const struct mesh *subject,
                  const struct nricp_landmarks *landmarks, const struct transfer_conf *conf, struct err *err);
void transfer_free(struct transfer *transfer);

/* Whether two meshes have the same faces of the same vertices. */
bool transfer_same_topology(const struct mesh *a, const struct mesh *b);

#endif
