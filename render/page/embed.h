/* The page's own text, put into the program by the assembler (render/page/page.html and its like). */
#ifndef RENDER_PAGE_EMBED_H
#define RENDER_PAGE_EMBED_H

/* Each ends with a zero byte. */
extern const char page_html[], page_css[], page_js[];
/* The interactive page: its frame, its shaders, its programs in the order they are run in. */
extern const char viewer_html[], viewer_css[], viewer_common[], viewer_decode[], viewer_paths[], viewer_refine[], viewer_ground[], viewer_lights[], viewer_beside[], viewer_march[], viewer_horizon[], viewer_iris[], viewer_eye_frag[],
                  viewer_bloom[], viewer_present[], viewer_lids[], viewer_tear[], viewer_skin_frag[], viewer_folds[], viewer_dress[], viewer_skin_vert[], viewer_pose[], viewer_probe[], viewer_copy[], viewer_tissue_js[], viewer_panorama_js[], viewer_beams_js[], viewer_motion_js[], viewer_gl_js[], viewer_scene_js[], viewer_known_js[], viewer_pose_js[], viewer_face_js[],
                  viewer_sliders_js[], viewer_address_js[], viewer_controls_js[], viewer_tools_js[], viewer_leaves_js[], viewer_live_js[], viewer_page_js[];
/* What an exported eye is assembled with by hand: templates of render/export. */
extern const char export_blender_py[], export_engines_md[];
/* config/animate.conf: how eyes move. */
extern const char viewer_motion_conf[];
/* lib/draw/eye/look.h, lib/draw/face/skin_look.h: a shader can read them. */
extern const char scene_look[], skin_look[];

#endif
