/* options: what config/calibrate.conf and capture.conf set for finding cameras and the person's mesh, and where the files stand
 * that one run leaves for the next: pictures/ (what COLMAP reads), pictures.json, faces.json, frames.json, database.db,
 * model/ (sealed), cloud.grid, colmap.log. A photograph that is added is compared with the others; nothing else is done again.
 * Ranges, units and meanings of the keys: stages/calibrate/main.c.
 */
#ifndef SFM_OPTIONS_H
#define SFM_OPTIONS_H
#include "anatomy/eye.h"
#include "anatomy/keys.h"
#include "base/opt.h"
#include "image/video/video.h"
#include "register/transfer.h"
#include "sfm/cloud/cloud.h"
#include "sfm/match/match.h"

#define CALIBRATE_DIR "work/calibrate"

struct calibrate_options {
	struct video_conf video;
	int video_frames, video_frames_beside;
	int picture_px, features, first_octave, max_views, min_matches, lens;
	double same_level, blur_warning, limit_mpx, regrow;
	struct sfm_overlap_conf overlap;
	int sequence_neighbours;
	double filter_px, tri_deg;
	int ba_rounds;
	struct camera_keys camera;
	double head_radius_mm, eyes_apart_mm, ruler_mm, marker_mm, limbus_radius_mm;
	bool find_eyes;
	struct opt_each_list left_eye, right_eye, mouth, ruler, distance;
	struct cloud_conf cloud;
	double best_angle_deg, max_slant_deg;
	int mesh_depth, mesh_faces, mesh_min_points;
	double mesh_trim;
	const char *template;         // relative to the capture; null: none
	double template_cells;
	struct transfer_conf transfer;
};

#endif
