/* transfer: registers a target (a character) onto the subject and expresses each of its vertices by barycentric coordinates of the
 * subject's mesh: the matrix B (skin paper, section 3.6, equation 3.4).
 *
 * Frame    the subject's axes (x to the person's left, y up, z out of the face), mm.
 */
#ifndef REGISTER_TRANSFER_H
#define REGISTER_TRANSFER_H
#include "register/nricp/nricp.h"
#include "register/nricp/align.h"

struct transfer_conf {
	struct nricp_conf nricp;
	struct nricp_align_conf align;
	double below_eyes, nearly;  // where shape leaves the way up open: share of a character below its eyes that tells it, of the other way's fit that it must reach
	double least_piece;      // share of the largest piece's area below which a piece is carried along, not matched
	double open;             // surface with a smaller openness (mesh_hidden: sockets, insides) is carried along, too
	double snap;             // distance from the subject at which a vertex's confidence has fallen to 1/e; share of its size
};

/* A registration. Arrays are by the target's vertices, in its mesh's order, and owned. */
struct transfer {
	int n;
	float (*registered)[3];        // the vertices on the subject, mm
	int32_t (*column)[3];          // row i of B: three vertices of the subject mesh, rising,
	double (*weight)[3];           // and their weights, >= 0, sum 1
	int32_t *face;                 // face of the subject mesh that it lies on; -1: of the same topology, a vertex of no face
	float (*bary)[3];              // weights of that face's corners
	float *distance, *confidence;  // mm from that place to registered; 0..1
	double subject_from_target[4][4];  // the similarity before the non-rigid registration
	double scale;                  // of the similarity
	double matched;                // share of the subject found by the similarity, 0..1
	double fine, rival;            // the same more narrowly, and that of the best other pose (nricp_align)
	double rms, covered;           // of the non-rigid registration: mm; share of the target that matched, 0..1
	bool weighed;                  // the shapes left open which way up it is: more of it lies below its eyes than above (transfer_lay)
	bool same_topology;            // vertex i is vertex i of the subject: nothing was registered
};

/* Registers a target onto the subject: similarity (nricp_align), non-rigid registration (nricp_run), then snaps each vertex to the
 * nearest face of the subject that faces the same way. Pieces that are small or hidden are carried along by their neighbours.
 * out              overwritten; transfer_free
 * target, subject  mm, faces counter-clockwise from outside; the target may be turned in any way
 * landmarks        pairs of vertices of the two meshes; null: none
 * Returns false, err set, when a mesh is invalid or no similarity brings them together; out is empty then, but for the similarity. */
bool transfer_run(struct transfer *out, const struct mesh *target, const struct mesh *subject,
                  const struct nricp_landmarks *landmarks, const struct transfer_conf *conf, struct err *err);
void transfer_free(struct transfer *transfer);

/* After a transfer_run that failed: fills the arrays so that a picture can be drawn of the target as the best similarity lays it.
 * registered is that, confidence 0 everywhere, and B is empty. */
void transfer_show_aligned(struct transfer *transfer, const struct mesh *target);

/* Whether two meshes have as many vertices and the same faces. */
bool transfer_same_topology(const struct mesh *a, const struct mesh *b);

#endif
