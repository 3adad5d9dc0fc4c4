/* What other programs' records hold, in plain words: numbers without exponents, what keys of figures stand for. */
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "render/page/page.h"

enum { DIGITS = 4, MOST = 64 };  // digits that count; bytes of the longest number
static const double least = 1e-6, most = 1e15;  // nearer to nought, or farther from it, nobody reads the digits

/* Thin spaces between groups of three digits, from five on; text: digits with a sign before and a fraction behind. free(). */
static char *grouped(const char *text)
{
	static const char thin[] = "\u202f";
	const char *first = text + (*text == '-');
	size_t n = strspn(first, "0123456789"), at = (size_t)(first - text);
	char *out = mem_new(strlen(text) + n * (sizeof thin - 1) + 1, 1);
	memcpy(out, text, at);
	for (size_t i = 0; i < n; i++) {
		if (i && n > 4 && (n - i) % 3 == 0) {
			memcpy(out + at, thin, sizeof thin - 1);
			at += sizeof thin - 1;
		}
		out[at++] = first[i];
	}
	strcpy(out + at, first + n);
	return out;
}

/* free(). */
static char *plain(double v)
{
	char text[MOST];
	const double a = fabs(v);
	if (isnan(v))
		return mem_str("not known");
	if (a < least)
		return mem_str(a == 0 ? "0" : v > 0 ? "below 0.000001" : "above -0.000001");
	if (a > most)
		return mem_str(v > 0 ? "above a million billions" : "below minus a million billions");
	const int digits = a < 0.001 ? 2 : DIGITS, decimals = digits - 1 - (int)floor(log10(a));
	snprintf(text, sizeof text, "%.*f", decimals > 0 ? decimals : 0, v);
	if (strchr(text, '.')) {
		char *end = text + strlen(text);
		while (end[-1] == '0')
			*--end = 0;
		if (end[-1] == '.')
			end[-1] = 0;
	}
	return grouped(text);
}

json_t *page_number(double value)
{
	char *text = plain(value);
	json_t *out = json_string(text);
	free(text);
	return out;
}

/* Length of the number with an exponent that text begins with; 0: it begins with none. */
static size_t exponent_at(const char *text)
{
	size_t n = strspn(text, "0123456789");
	if (!n)
		return 0;
	if (text[n] == '.')
		n += 1 + strspn(text + n + 1, "0123456789");
	if (text[n] != 'e' && text[n] != 'E')
		return 0;
	const size_t sign = n + 1 + (text[n + 1] == '-' || text[n + 1] == '+'), end = sign + strspn(text + sign, "0123456789");
	return end > sign && !isalnum((unsigned char)text[end]) && text[end] != '_' ? end : 0;
}

json_t *page_sentence(const char *text)
{
	char *out = 0;
	size_t size;
	FILE *f = open_memstream(&out, &size);
	for (const char *p = text; *p;) {
		// Digits within a word are part of a name.
		const size_t n = p > text && (isalnum((unsigned char)p[-1]) || p[-1] == '_' || p[-1] == '.' || (unsigned char)p[-1] > 127) ? 0 : exponent_at(p);
		if (n && n < 64) {
			char *number = plain(strtod(p, 0));
			fputs(number, f);
			free(number);
			p += n;
		} else {
			fputc(*p++, f);
		}
	}
	fclose(f);
	json_t *json = template_text(out);
	free(out);
	return json;
}

/* unit: in place of the record's own; null: as that has it. */
static const struct word { const char *key, *words, *unit; } words[] = {
	{ "texels_left_out", "texels left out", 0 },
	{ "texels per mm", "texels", "per mm" },
	{ "detail_rms", "detail of the thickness (root mean square)", 0 },
	{ "iris_seen", "iris seen", 0 },
	{ "thickness_mean", "mean thickness of the stroma", 0 },
	{ "residual", "left over by the fit", 0 },
	{ "residual_colour", "of the colours alone left over by the fit", 0 },
	{ "abl_melanin", "melanin in the border layer", "% of its volume" },
	{ "stroma_melanin", "melanin in the stroma", "% of its volume" },
	{ "minima", "solutions found from different starts", 0 },
	{ "held_by_priors", "directions in which the photographs tell little, so that what is usual among people decides", "of 9" },
	{ "detail_residual", "of the photograph's fine detail left over by the fit", 0 },
	{ "detail_residual_coarse", "of it left over before", 0 },
	{ "height_rms", "height of the relief (root mean square)", 0 },
	{ "refraction_error_mean", "mean error of where light crosses the cornea", 0 },
	{ "refraction_error_worst", "worst error of it", 0 },
	{ "refraction_bytes", "size of the table of it", 0 },
	{ "refraction_steps", "Newton's steps", 0 },
	{ "registered", "views whose camera was found", 0 },
	{ "points", "points of the scene", 0 },
	{ "cloud", "of the dense cloud", 0 },
	{ "scale_sigma", "standard deviation of the scale", 0 },
	{ "template_residual", "from the laid template to the middle point", 0 },
	{ "surface_residual", "from the surface to the middle point", 0 },
	{ "eyes_found", "in which eyes were found", 0 },
	{ "mouth_found", "in which a mouth was found", 0 },
	{ "subject_vertices", "vertices of the subject's mesh", 0 },
	{ "track_frames", "frames followed", 0 },
	{ "track_still_frames", "frames", 0 },
	{ "track_points", "points of skin", 0 },
	{ "track_seen", "share of them seen", 0 },
	{ "track_pose", "from the eyes' openings to the head's pose", 0 },
	{ "wrinkle_lines", "lines of wrinkles", 0 },
	{ "wrinkle_deepest", "the deepest wrinkle", 0 },
	{ "train_folding", "most that the one matrix differs from the equations it is folded from", 0 },
	{ "train_aperture_sigma", "standard deviation of how far lids open", 0 },
	{ "aligned_share", "of the subject found on the character", 0 },
	{ "residual_rms", "between both meshes (root mean square)", 0 },
	{ "distance_95", "between both meshes, 95 % of it is nearer", 0 },
	{ "tracked_vertices", "vertices that follow the video", 0 },
	{ "lid_vertices", "vertices of the lids", 0 },
	{ "extrapolated_vertices", "vertices moved by what is known of the others", 0 },
	{ "globe_radius", "radius of the eyeballs", 0 },
	{ "lids_beside_skin", "error of the lids", 0 },
	{ "lids_folded_error", "error of the lids", 0 },
	{ "least_distance", "least distance", 0 },
	{ "off_chart", "error of the registration", 0 },
	{ "open_when_closed", "gap of closed lids", 0 },
	{ "open_after_sealing", "gap of closed lids that is left", 0 },
	{ "animation_outside", "beyond the gazes that were learnt", 0 },
	{ "animation_frames", "frames", 0 },
	{ "animation_saccades", "saccades", 0 },
	{ "animation_blinks", "blinks", 0 },
	// registration.json
	{ "scale", "scale between person and character", 0 },
	{ "target_unit_mm", "one unit of the character", "mm" },
	{ "subject_unit_mm", "one unit of the person's mesh", "mm" },
	{ "turned_deg", "turned against the person", "°" },
	{ "aligned_closely", "share of it that lies closely", 0 },
	{ "aligned_closely_otherwise", "the same in the second best pose", 0 },
	{ "follow_share", "share of the character that follows the person", 0 },
	{ "subject_covered", "share of the person's mesh that is covered", 0 },
	{ "flipped_triangles", "triangles turned over", 0 },
	{ "stretch_95", "stretch, 95 % of the edges have less", "times" },
	{ "eyes_off", "the worse eyeball from where the person's is", "of the distance between them" },
	{ "landmarks_off", "landmarks from where the person's are", "of the person's size" },
	{ "matched_share", "share of the person found on the character", 0 },
	{ "residual_rms_mm", "between both meshes (root mean square)", "mm" },
	{ "distance_median_mm", "between both meshes, in the median", "mm" },
	{ "distance_95_mm", "between both meshes, 95 % of it is nearer", "mm" },
	{ "vertices", "vertices of the character", 0 },
	{ "trusted_vertices", "vertices that follow the person's surface", 0 },
};

/* Figures of one photograph begin with its name. */
static const struct word of_a_photo[] = {
	{ " theta sigma", ": standard deviation of the tilt", 0 },
	{ " theta", ": tilt of the eye", 0 },
	{ " rms", ": the limbus off its ellipse", 0 },
	{ " limbus seen", ": limbus seen", 0 },
};

/* Those of training, with the part of the model before them: errors of frames that were not learnt from. */
static const struct word of_training[] = {
	{ "_error_rbf", ": error of frames not learnt from, by radial basis functions", 0 },
	{ "_error", ": error of frames not learnt from, 1 is no better than the mean", 0 },
	{ "_px", ": error of frames not learnt from", 0 },
};

/* Units as records write them, and as they are read. */
static const struct { const char *from, *to; } units[] = { { "deg", "°" }, { "mm2", "mm²" }, { "/mm", "per mm" }, { "B", "bytes" } };

static bool ends(const char *text, const char *with)
{
	const size_t n = strlen(text), m = strlen(with);
	return n > m && !strcmp(text + n - m, with);
}

/* The first n bytes of a key as words. free(). */
static char *spaced(const char *key, size_t n)
{
	char *out = mem_printf("%.*s", (int)n, key);
	for (char *p = out; *p; p++)
		*p = *p == '_' ? ' ' : *p;
	return out;
}

/* free(). */
static char *label_of(const char *key, const struct word **word)
{
	static const char train[] = "train_";
	*word = 0;
	for (int i = 0; i < COUNT(of_a_photo); i++)
		if (ends(key, of_a_photo[i].key))
			return mem_printf("%.*s%s", (int)(strlen(key) - strlen(of_a_photo[i].key)), key, of_a_photo[i].words);
	for (int i = 0; i < COUNT(words); i++)
		if (!strcmp(key, words[i].key)) {
			*word = &words[i];
			return mem_str(words[i].words);
		}
	for (int i = 0; i < COUNT(of_training) && !strncmp(key, train, strlen(train)); i++)
		if (ends(key, of_training[i].key)) {
			char *part = spaced(key + strlen(train), strlen(key) - strlen(train) - strlen(of_training[i].key)), *label = mem_printf("%s%s", part, of_training[i].words);
			free(part);
			return label;
		}
	return spaced(key, strlen(key));
}

json_t *page_figure(const char *key, double value, const char *unit)
{
	const struct word *word;
	char *label = label_of(key, &word);
	unit = word && word->unit ? word->unit : unit ? unit : "";
	for (int i = 0; i < COUNT(units); i++)
		if (!strcmp(unit, units[i].from))
			unit = units[i].to;
	json_t *out = json_pack("{s:o,s:o,s:o}", "label", template_text(label), "value", page_number(value), "unit", page_sentence(unit));
	free(label);
	return out;
}
