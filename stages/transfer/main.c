/* transfer: registers every character on the subject and writes its vertices' barycentric coordinates there.
 * reads   subject.ply or subject.obj (else work/subject.ply), targets/NAME.glb, .gltf, .fbx, .obj or .ply and what these refer to
 * writes  work/targets/NAME/registered.ply (mm, the subject's axes; the target's vertices and faces),
 *         barycentric.npz (B, eq. 3.4), registration.json, registration.png; of a refused character the last two alone;
 *         of one with materials character.ply (its surface, in its own unit and axes) and look.npz (lib/character/look.h)
 */
#include "anatomy/keys.h"
#include "base/mem.h"
#include "register/transfer_opts.h"
#include "stages/transfer/transfer_stage.h"

int main(int argc, char **argv)
{
	struct transfer_stage_conf conf = { 0 };
	double nodes[NRICP_LEVELS], rounds[NRICP_LEVELS];
	const struct opt opts[] = {
		TRANSFER_OPTS("", &conf.transfer, nodes, rounds),
		OPT_REAL("limit_vertices", &conf.limit_vertices, 100, 1e8, "", "larger meshes are refused"),
		OPT_REAL("import_seconds", &conf.import_seconds, 1, 3600, "s", "of processor time for reading a character's file"),
		OPT_REAL("import_mib", &conf.import_mib, 64, 1e5, "MiB", "of memory for reading a character's file; half of it for what is in it"),
		SUBJECT_UNIT_OPT(&conf.subject_unit),
		SUBJECT_LANDMARK_OPT(&conf.subject_landmark),
		SUBJECT_EYE_OPTS(&conf.eye_radius, &conf.eye_center),
		OPT_REAL("check_covered", &conf.check.covered, 0, 1, "", "least share of the subject that a character lies on"),
		OPT_REAL("check_flipped", &conf.check.flipped, 0, 1, "", "most flipped triangles, share of those that follow"),
		OPT_REAL("check_stretch", &conf.check.stretch, 0, 10, "", "most stretch of edges (95 %), natural logarithm"),
		OPT_REAL("check_eyes", &conf.check.eyes, 0, 10, "", "most distance of an eyeball from the subject's, of that between these"),
		OPT_REAL("check_landmarks", &conf.check.landmarks, 0, 10, "size", "most mean distance of given landmarks from their places"),
		OPT_EACH("target.*.unit_mm", &conf.target_unit, 1, 1e-6, 1e6, "mm", "one unit of that character's mesh"),
		OPT_EACH("target.*.landmarks", &conf.target_landmarks, 0, 0, 0, "", "\"name row, name row\": the subject's landmarks on it"),
	};
	struct stage stage;
	struct err err = { 0 };
	stage_start(&stage, "transfer", "lay characters onto the subject", argc, argv, COUNT(opts), opts);
	transfer_conf_take(&conf.transfer, nodes, rounds);
	transfer_stage(&stage, &conf, &err);
	return stage_end(&stage, &err);
}
