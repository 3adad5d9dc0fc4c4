#include "render/page/embed.h"

/* C23's #embed is newer than the compilers; .incbin is in both their assemblers. Paths are the repository's. */
#define EMBED(name, file) \
	__asm__(".section .rodata\n.global " #name "\n" #name ":\n.incbin \"" file "\"\n.byte 0\n.previous\n")

EMBED(page_html, "render/page/page.html");
EMBED(page_css, "render/page/page.css");
EMBED(page_js, "render/page/page.js");

EMBED(viewer_html, "render/viewer/viewer.html");
EMBED(viewer_css, "render/viewer/viewer.css");
EMBED(viewer_common, "render/viewer/common.glsl");
EMBED(viewer_decode, "render/viewer/decode.frag");
EMBED(viewer_paths, "render/viewer/paths.frag");
EMBED(viewer_refine, "render/viewer/refine.frag");
EMBED(viewer_ground, "render/viewer/ground.glsl");
EMBED(viewer_lights, "render/viewer/lights.glsl");
EMBED(viewer_beside, "render/viewer/beside.frag");
EMBED(viewer_march, "render/viewer/march.frag");
EMBED(viewer_horizon, "render/viewer/horizon.frag");
EMBED(viewer_iris, "render/viewer/iris.glsl");
EMBED(viewer_eye_frag, "render/viewer/eye.frag");
EMBED(viewer_bloom, "render/viewer/bloom.frag");
EMBED(viewer_present, "render/viewer/present.frag");
EMBED(viewer_lids, "render/viewer/lids.glsl");
EMBED(viewer_tear, "render/viewer/tear.frag");
EMBED(viewer_skin_frag, "render/viewer/skin.frag");
EMBED(viewer_folds, "render/viewer/folds.glsl");
EMBED(viewer_dress, "render/viewer/dress.glsl");
EMBED(viewer_skin_vert, "render/viewer/skin.vert");
EMBED(viewer_pose, "render/viewer/pose.glsl");
EMBED(viewer_probe, "render/viewer/probe.frag");
EMBED(viewer_copy, "render/viewer/copy.frag");
EMBED(viewer_tissue_js, "render/viewer/tissue.js");
EMBED(viewer_panorama_js, "render/viewer/panorama.js");
EMBED(viewer_motion_js, "render/viewer/motion.js");
EMBED(viewer_beams_js, "render/viewer/beams.js");
EMBED(viewer_gl_js, "render/viewer/gl.js");
EMBED(viewer_scene_js, "render/viewer/scene.js");
EMBED(viewer_known_js, "render/viewer/known.js");
EMBED(viewer_pose_js, "render/viewer/pose.js");
EMBED(viewer_face_js, "render/viewer/face.js");
EMBED(viewer_sliders_js, "render/viewer/sliders.js");
EMBED(viewer_address_js, "render/viewer/address.js");
EMBED(viewer_controls_js, "render/viewer/controls.js");
EMBED(viewer_tools_js, "render/viewer/tools.js");
EMBED(viewer_leaves_js, "render/viewer/leaves.js");
EMBED(viewer_live_js, "render/viewer/live.js");
EMBED(viewer_page_js, "render/viewer/page.js");
EMBED(export_blender_py, "render/export/blender_eye.py");
EMBED(export_engines_md, "render/export/engines.md");
EMBED(scene_look, "lib/draw/eye/look.h");
EMBED(skin_look, "lib/draw/face/skin_look.h");
EMBED(viewer_motion_conf, "config/animate.conf");
