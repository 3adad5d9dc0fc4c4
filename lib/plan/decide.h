/* decide: which stages a capture folder needs, why the others are not needed, and about how long each takes. It reads names and the
 * first bytes of photographs, a character's mesh only where that has as many vertices as the subject's, and of a video alone whose lens is not
 * given the first frames, once (film.h): every make calls it.
 */
#ifndef PLAN_DECIDE_H
#define PLAN_DECIDE_H
#include "base/conf.h"
#include "plan/stages.h"

/* What a stage costs on two processors. Seconds: fixed, for each megapixel of all photographs, each million texels of the iris map, each thousand frames of the video,
 * each character, and each character's thousand frames of clips. Memory: fixed, and for each megapixel of the largest photograph. */
enum { PLAN_SECONDS = 6 };
struct plan_cost {
	double seconds[PLAN_SECONDS], mib[2];
};

struct plan_row {
	const char *name;
	bool run;
	bool told;           // does not, since capture.conf gives what it would find
	const char *reason;  // fixed texts: they go into plan.mk
	double seconds;      // estimate; 0 when it does not run
	double peak_mib;     // of memory, estimate; 0 when it does not run
	char *setting;       // chosen from the measured fronts; null: the preset. Owned by the plan
};

struct plan_skin;

/* Where characters' irises come from: "photographs", "video" or "drawn"; why: of plan_skins (skin.h), null: no character is driven. */
struct plan_iris {
	const char *from;
	char *why;
};

struct plan {
	const char *capture;
	struct plan_row rows[PLAN_STAGES];
	int n_run;           // plan itself not counted
	bool unbuilt;        // a stage does not run because its program is not there
	int n_photos;
	double mpx;          // of all photographs, as far as their heads tell
	double largest_mpx;  // of one
	double mtexel;       // million texels of an iris map, as large as they will be (setting.h)
	int n_characters;    // in targets/
	double kframes;      // thousand frames of the video, as its header promises
	double clip_kframes; // of what is rendered of each character: the first minute of the video, and a script, taken to be as long
	char asked[64];      // "error = 0.05 mm", or ""
	int n_skins;
	struct plan_skin *skins;  // of the characters that are driven (skin.h)
	struct plan_iris iris;
	char listing[33];    // hash of the names that decide
};

/* Seconds of a stage, by what the plan's folder holds. */
double plan_cost_seconds(const struct plan_cost *cost, const struct plan *plan);

/* Decides from what the folder holds, from capture.conf (conf: whether it gives the lens) and from which programs are built.
 * plan     out; its texts are constants, but for rows[].setting (setting.h)
 * capture  path of the folder; kept in plan
 * cost     one for each stage, in the order of plan_stages
 * Returns false, err set, when there is no such folder, its work/ is a link, or it holds nothing to work on. */
bool plan_decide(struct plan *plan, const char *capture, const struct plan_cost cost[PLAN_STAGES], const struct conf *conf,
                 struct err *err);

/* Whether the folder brings a mesh of the person: none is made of views/ then. */
bool plan_has_subject(const char *capture);

#endif
