/* transfer: lays every character onto the subject, and says what of the subject's skin each of its vertices follows.
 * reads   subject.ply or subject.obj (else work/subject.ply), targets/NAME.ply or .obj
 * writes  work/targets/NAME/registered.ply (mm, the subject's axes; the target's vertices and faces),
 *         barycentric.npz (B, eq. 3.4), transfer.json
 */
#include "base/mem.h"
#include "stages/transfer/transfer_stage.h"

int main(int argc, char **argv)
{
	struct transfer_stage_conf conf = { 0 };
	struct nricp_conf *n = &conf.transfer.nricp;
	struct nricp_align_conf *a = &conf.transfer.align;
	double nodes[NRICP_LEVELS], rounds[NRICP_LEVELS];
	const struct opt opts[] = {
		OPT_REALS("nodes", nodes, NRICP_LEVELS, 0, 1e6, "", "of the deformation graph, coarse to fine"),
		OPT_REALS("rounds", rounds, NRICP_LEVELS, 0, 1000, "", "of matching and solving on each"),
		OPT_REALS("stiff", n->stiff, 2, 1e-4, 10, "size", "length over which the deformation bends, first and last round"),
		OPT_REAL("noise", &n->noise, 0, 100, "sigma", "of the subject's noise, by which the last is longer"),
		OPT_REAL("rigid", &n->rigid, 1e-3, 100, "size", "length above which it rather bends than stretches"),
		OPT_REAL("growth", &n->growth, 0, 1, "", "share of local growth that counts as rigid"),
		OPT_REAL("turn", &n->turn, 0, 10, "size", "length that counts as much as a normal turned by a radian"),
		OPT_REAL("slide", &n->slide, 0, 1, "", "weight of distance along the surface over that across it"),
		OPT_REALS("welsch", n->welsch, 2, 1e-3, 10, "size", "scale of the robust weight, first and last round"),
		OPT_REAL("facing", &n->facing, -1, 1, "", "least cosine between matched normals"),
		OPT_REAL("rim", &n->rim, 0, 100, "", "weight of boundaries matched to boundaries; 0: they are free"),
		OPT_REAL("rim_slide", &n->rim_slide, 0, 1, "", "weight of distance along a boundary over that across it"),
		OPT_REAL("rim_reach", &n->rim_reach, 1e-3, 10, "size", "scale of the boundaries' robust weight"),
		OPT_INT("polish_rounds", &n->polish_rounds, 0, 100, "", "last steps, of all vertices along their normals"),
		OPT_REAL("polish", &n->polish, 0, 10, "size", "length over which these are smooth"),
		OPT_INT("align_samples", &a->samples, 10, 100000, "", "points of the subject for the similarity"),
		OPT_INT("align_rounds", &a->rounds, 1, 1000, "", "of matching and solving from one start"),
		OPT_REALS("align_welsch", a->welsch, 2, 1e-3, 10, "size", "scale of the robust weight, first and last round"),
		OPT_REAL("align_facing", &a->facing, -1, 1, "", "least cosine between matched normals"),
		OPT_REAL("align_scale_max", &a->scale_max, 1, 100, "", "largest factor between character and subject"),
		OPT_REAL("align_good", &a->good, 0, 1, "", "share of the subject found, with which no further start is tried"),
		OPT_REAL("align_least", &a->least, 0, 1, "", "share of the subject found, below which there is no likeness"),
		OPT_INT("align_starts", &a->starts, 0, 10000, "", "places of the character tried where turning does not help"),
		OPT_REAL("open", &conf.transfer.open, 0, 0.5, "", "surface with less before it free is carried along: sockets, insides"),
		OPT_REAL("least_piece", &conf.transfer.least_piece, 0, 1, "", "pieces smaller than this share of the largest are carried along"),
		OPT_REAL("snap", &conf.transfer.snap, 1e-3, 10, "size", "distance from the subject at which trust has fallen to 1/e"),
		OPT_REAL("limit_vertices", &conf.limit_vertices, 100, 1e8, "", "larger meshes are refused"),
		OPT_REAL_UNSET("subject.unit_mm", &conf.subject_unit, 1e-6, 1e6, "mm", "one unit of the subject's mesh"),
		OPT_EACH("subject.landmark.*", &conf.subject_landmark, 1, 0, 1e9, "", "row of the subject's mesh"),
		OPT_EACH("target.*.unit_mm", &conf.target_unit, 1, 1e-6, 1e6, "mm", "one unit of that character's mesh"),
		OPT_EACH("target.*.landmarks", &conf.target_landmarks, 0, 0, 0, "", "\"name row, name row\": the subject's landmarks on it"),
	};
	struct stage stage;
	struct err err = { 0 };
	stage_start(&stage, "transfer", "lay characters onto the subject", argc, argv, COUNT(opts), opts);
	for (int i = 0; i < NRICP_LEVELS; i++) {
		n->nodes[i] = (int)nodes[i];
		n->rounds[i] = (int)rounds[i];
	}
	a->turn = n->turn;
	transfer_stage(&stage, &conf, &err);
	return stage_end(&stage, &err);
}
