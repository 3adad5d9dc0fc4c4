/* transfer_opts: the parameters of a registration as rows of a stage's option table, for the stages that register meshes.
 * p              prefix of the keys ("", or "template_")
 * c              struct transfer_conf *, filled in but for the two arrays
 * nodes, rounds  double[NRICP_LEVELS]; transfer_conf_take copies them to c once the options are parsed
 */
#ifndef REGISTER_TRANSFER_OPTS_H
#define REGISTER_TRANSFER_OPTS_H
#include "base/opt.h"
#include "register/transfer.h"

#define TRANSFER_OPTS(p, c, nodes, rounds) \
	OPT_REALS(p "nodes", nodes, NRICP_LEVELS, 0, 1e6, "", "of the deformation graph, coarse to fine"), \
	OPT_REALS(p "rounds", rounds, NRICP_LEVELS, 0, 1000, "", "of matching and solving on each"), \
	OPT_REALS(p "stiff", (c)->nricp.stiff, 2, 1e-4, 10, "size", "length over which the deformation bends, first and last round"), \
	OPT_REAL(p "noise", &(c)->nricp.noise, 0, 100, "sigma", "of the subject's noise, by which the last is longer"), \
	OPT_REAL(p "rigid", &(c)->nricp.rigid, 1e-3, 100, "size", "length above which it rather bends than stretches"), \
	OPT_REAL(p "growth", &(c)->nricp.growth, 0, 1, "", "share of local growth that counts as rigid"), \
	OPT_REAL(p "turn", &(c)->nricp.turn, 0, 10, "size", "length that counts as much as a normal turned by a radian"), \
	OPT_REAL(p "slide", &(c)->nricp.slide, 0, 1, "", "weight of distance along the surface over that across it"), \
	OPT_REALS(p "welsch", (c)->nricp.welsch, 2, 1e-3, 10, "size", "scale of the robust weight, first and last round"), \
	OPT_REAL(p "facing", &(c)->nricp.facing, -1, 1, "", "least cosine between matched normals"), \
	OPT_REAL(p "rim", &(c)->nricp.rim, 0, 100, "", "weight of boundaries matched to boundaries; 0: they are free"), \
	OPT_REAL(p "rim_slide", &(c)->nricp.rim_slide, 0, 1, "", "weight of distance along a boundary over that across it"), \
	OPT_REAL(p "rim_reach", &(c)->nricp.rim_reach, 1e-3, 10, "size", "scale of the boundaries' robust weight"), \
	OPT_REAL(p "mirror", &(c)->nricp.mirror, 0, 1, "", "weight of the other half's mirror image where nothing matches; 0: none"), \
	OPT_INT(p "polish_rounds", &(c)->nricp.polish_rounds, 0, 100, "", "last steps, of all vertices along their normals"), \
	OPT_REAL(p "polish", &(c)->nricp.polish, 0, 10, "size", "length over which these are smooth"), \
	OPT_REAL(p "polish_noise", &(c)->nricp.polish_noise, 0, 100, "sigma", "of the subject's noise, by which that is longer"), \
	OPT_INT(p "align_samples", &(c)->align.samples, 10, 100000, "", "points of the subject for the similarity"), \
	OPT_INT(p "align_rounds", &(c)->align.rounds, 1, 1000, "", "of matching and solving from one start"), \
	OPT_REALS(p "align_welsch", (c)->align.welsch, 2, 1e-3, 10, "size", "scale of the robust weight, first and last round"), \
	OPT_REAL(p "align_facing", &(c)->align.facing, -1, 1, "", "least cosine between matched normals"), \
	OPT_REAL(p "align_scale_max", &(c)->align.scale_max, 1, 100, "", "largest factor between character and subject"), \
	OPT_REAL(p "align_fine", &(c)->align.fine, 1e-3, 10, "size", "scale of the robust weight by which poses are compared"), \
	OPT_REAL(p "align_margin", &(c)->align.margin, 1, 100, "", "least ratio of what another pose leaves unmatched at that scale to what the best leaves"), \
	OPT_REAL(p "align_good", &(c)->align.good, 0, 1, "", "share at that scale, below which places all over the character are tried"), \
	OPT_REAL(p "align_least", &(c)->align.least, 0, 1, "", "share of the subject found, below which there is no likeness"), \
	OPT_INT(p "align_starts", &(c)->align.starts, 0, 10000, "", "places of the character tried where turning does not help"), \
	OPT_REAL(p "below_eyes", &(c)->below_eyes, 0.5, 1, "", "share of a character below its eyes from which that tells its way up"), \
	OPT_REAL(p "nearly", &(c)->nearly, 0, 1, "", "of the other way's close share, that the way told so must have"), \
	OPT_REAL(p "open", &(c)->open, 0, 0.5, "", "surface with less before it free is carried along: sockets, insides"), \
	OPT_REAL(p "least_piece", &(c)->least_piece, 0, 1, "", "pieces smaller than this share of the largest are carried along"), \
	OPT_REAL(p "snap", &(c)->snap, 1e-3, 10, "size", "distance from the subject at which trust has fallen to 1/e")

static inline void transfer_conf_take(struct transfer_conf *c, const double nodes[NRICP_LEVELS], const double rounds[NRICP_LEVELS])
{
	for (int i = 0; i < NRICP_LEVELS; i++) {
		c->nricp.nodes[i] = (int)nodes[i];
		c->nricp.rounds[i] = (int)rounds[i];
	}
	c->align.turn = c->nricp.turn;
}

#endif
