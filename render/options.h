/* The options of render. */
#ifndef RENDER_OPTIONS_H
#define RENDER_OPTIONS_H
#include "anatomy/keys.h"
#include "anatomy/light.h"
#include "render/render.h"

static const char *const render_quadratures[] = { "gauss", "midpoint", "exponential", 0 };
static const char *const render_shadings[] = { "rays", "texels", 0 };
static const char *const render_paths[] = { "grid", "ends", 0 };

#define RENDER_OPTS(c) \
	OPT_INT("map_size", &(c)->scene.map_size, 128, 8192, "px", "texels across the iris maps, at most"), \
	OPT_INT("search", &(c)->scene.search, 2, 64, "", "steps of the search for the relief"), \
	OPT_INT("shadow", &(c)->scene.shadow, 0, 64, "", "steps of the shadow of the relief; 0: none"), \
	OPT_INT("steps", &(c)->scene.steps, 2, SCENE_NODES_MAX, "", "steps of the march through the iris"), \
	OPT_CHOICE("quadrature", &(c)->scene.quadrature, render_quadratures, "where the steps lie"), \
	OPT_CHOICE("shading", &(c)->scene.shading, render_shadings, "the march: along every ray of sight, or once a view from the map's texels"), \
	OPT_INT("shading_apart", &(c)->scene.apart, 1, 8, "", "texels from one that is marched from to the next"), \
	OPT_CHOICE("light_path", &(c)->scene.path, render_paths, "light through the cornea: a table a light, or solved for each ray"), \
	OPT_INT("bands", &(c)->scene.bands, 3, TISSUE_BANDS_MAX, "", "wavelengths"), \
	OPT_REAL("albedo_mm", &(c)->scene.albedo_mm, 0.05, 3, "mm", "what photograph over model changes by over more than this, in luminance, is the photograph's light"), \
	OPT_REAL("albedo_most", &(c)->scene.albedo_most, 1, 20, "", "what is finer is the iris' albedo, within this factor"), \
	OPT_REAL("own_width", &(c)->scene.own_width, 0.01, 2, "", "sigma of a light's mean direction from the photograph's, over which the photograph's own light fades"), \
	OPT_REAL("ratio_most", &(c)->scene.ratio_most, 1, 20, "", "most that another light brightens a texel over the photograph"), \
	OPT_REAL("ratio_chroma", &(c)->scene.ratio_chroma, 1, 10, "", "most that a channel of that differs from the channels' mean"), \
	OPT_REAL("detail", &(c)->scene.detail, 0, 1, "", "how much of what the photograph shows beyond the model is shown"), \
	OPT_REAL_UNSET("limbus_width_mm", &(c)->scene.limbus_width, 0.05, 2, "mm", "over which sclera turns into cornea; unset: as photographed"), \
	OPT_REAL("sclera_radius_mm", &(c)->scene.sclera_radius, 9, 16, "mm", "radius of the eyeball"), \
	OPT_REALS("sclera_rgb", (c)->scene.sclera_rgb, 3, 0, 1, "", "colour of the sclera where no photograph shows it"), \
	OPT_REAL("socket_share", &(c)->socket_share, 0, 10, "", "a fitted eye is scaled to a character's eyeballs; said so where it is by more than this share"), \
	OPT_REAL("vein_density", &(c)->scene.vein_density, 0, 5, "", "vessels of the sclera"), \
	OPT_INT("vein_map_px", &(c)->scene.veins_px, 128, 8192, "px", "texels across the map of the sclera"), \
	OPT_INT("seed", &(c)->scene.seed, 0, 1000000, "", "of the vessels"), \
	OPT_INT("lights", &(c)->lights, 1, 64, "", "beams into the eye, each of light_directions of the environment"), \
	OPT_INT("light_directions", &(c)->light_directions, 1, 8, "", "directions of the environment in a beam: 1, 2, 4 or 8"), \
	OPT_INT("passes", &(c)->passes, 1, 4096, "", "light drawn anew within its areas; more than one: converging to area light"), \
	OPT_INT("samples", &(c)->samples, 1, 8, "", "rays across a pixel, at edges"), \
	OPT_INT("size_px", &(c)->size_px, 64, 8192, "px", "width of front and three-quarter"), \
	OPT_INT("photo_px", &(c)->photo_px, 64, 8192, "px", "longest side of the photograph's own view"), \
	OPT_INT("frames", &(c)->frames, 1, 64, "", "of the turntable"), \
	OPT_INT("frame_px", &(c)->frame_px, 64, 2048, "px", "width of a turntable frame"), \
	OPT_REAL("frame_deg", &(c)->frame_deg, 0, 90, "deg", "the turntable turns this far to both sides"), \
	OPT_REAL("field_mm", &(c)->field_mm, 10, 60, "mm", "what front and three-quarter show"), \
	OPT_REALS("three_quarter_deg", (c)->three_quarter_deg, 2, -80, 80, "deg", "yaw and pitch of the eye"), \
	OPT_STR("environment", &(c)->environment, "latitude-longitude EXR in the capture folder; unset: a studio"), \
	OPT_REAL("bloom", &(c)->finish.bloom, 0, 1, "", "share of the light that a lens scatters over the picture: bright light glows"), \
	OPT_REAL("tone", &(c)->finish.tone, 0, 1, "", "share of a film's curve: highlights bend towards white instead of being cut off"), \
	OPT_BOOL("freckles", &(c)->freckles, "show the freckles, too"), \
	OPT_BOOL("exr", &(c)->exr, "write linear pictures beside the PNG"), \
	OPT_BOOL("film", &(c)->film, "the turntable as a film"), \
	OPT_INT("sheet_px", &(c)->sheet_px, 300, 6000, "px", "width of the contact sheet"), \
	OPT_INT("page_px", &(c)->page_px, 100, 2000, "px", "width of the review page's pictures"), \
	OPT_REAL("page_glb_mib", &(c)->page_glb_mib, 0, 64, "MiB", "largest .glb of a character that the interactive page carries, to be saved as set"), \
	OPT_STR("shots", &(c)->shots, "JSON in the capture folder: further pictures, each with pose and light"), \
	LIGHT_POLARISED_OPT(&(c)->polarised), \
	LIGHT_ENVIRONMENT_OPT(&(c)->light), \
	LIMIT_PHOTO_OPT(&(c)->limit_mpx)

#endif
