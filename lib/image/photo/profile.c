#include "image/photo/profile.h"

#include <ctype.h>
#include <lcms2.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

/* Code values of 16 bits by which a profile may differ from sRGB and still be taken for it: a quarter of an 8-bit step. Profiles of sRGB
 * differ in the rounding of their curves and white points. */
enum { SAME = 64 };

static void describe(char name[64], cmsHPROFILE profile)
{
	cmsUInt32Number n = cmsGetProfileInfoASCII(profile, cmsInfoDescription, "en", "US", name, 64);
	name[n < 63 ? n : 63] = 0;
	for (char *c = name; *c; c++)
		if (!isprint((unsigned char)*c))
			*c = '?';
}

/* Whether the transform leaves colours all over the cube where they are. */
static bool is_identity(cmsHTRANSFORM transform, bool grey)
{
	enum { STEPS = 9 };
	for (int i = 0; i < STEPS * STEPS * STEPS; i++) {
		int at[3] = { i % STEPS, i / STEPS % STEPS, i / STEPS / STEPS };
		uint16_t in[3], out[3];
		for (int c = 0; c < 3; c++)
			in[c] = (uint16_t)(65535 * at[grey ? 0 : c] / (STEPS - 1));
		cmsDoTransform(transform, in, out, 1);
		for (int c = 0; c < 3; c++)
			if (abs(in[c] - out[c]) > SAME)
				return false;
	}
	return true;
}

static void convert(cmsHTRANSFORM transform, uint16_t *rgb, size_t n, bool grey)
{
	enum { CHUNK = 1 << 14 };
	long chunks = (long)((n + CHUNK - 1) / CHUNK);
	// Pixels do not depend on each other: the result is the same on any number of threads.
#pragma omp parallel for schedule(static)
	for (long k = 0; k < chunks; k++) {
		size_t from = (size_t)k * CHUNK, count = n - from < CHUNK ? n - from : CHUNK;
		uint16_t *px = rgb + 3 * from, *one = grey ? mem_array(count, sizeof *one) : px;
		for (size_t i = 0; grey && i < count; i++)
			one[i] = px[3 * i];
		cmsDoTransform(transform, one, px, (cmsUInt32Number)count);
		if (grey)
			free(one);
	}
}

static bool apply(char name[64], uint16_t *rgb, size_t n, bool grey, cmsHPROFILE profile, struct err *err)
{
	cmsContext context = cmsGetProfileContextID(profile);
	cmsHPROFILE srgb = cmsCreate_sRGBProfileTHR(context);
	cmsUInt32Number in = grey ? TYPE_GRAY_16 : TYPE_RGB_16;
	// No cache: the transform is shared by threads.
	cmsHTRANSFORM transform = cmsCreateTransformTHR(context, profile, in, srgb, TYPE_RGB_16, INTENT_RELATIVE_COLORIMETRIC,
	                                                cmsFLAGS_NOCACHE | cmsFLAGS_BLACKPOINTCOMPENSATION | cmsFLAGS_HIGHRESPRECALC);
	cmsCloseProfile(srgb);
	if (!transform)
		return err_set(err, "has a colour profile that says nothing of %s pixels: convert it to sRGB", grey ? "grey" : "RGB");
	describe(name, profile);
	if (is_identity(transform, grey))
		*name = 0;
	else
		convert(transform, rgb, n, grey);
	cmsDeleteTransform(transform);
	return true;
}

bool photo_profile_apply(char name[64], uint16_t *rgb, size_t n, bool grey, const void *profile, size_t size, struct err *err)
{
	*name = 0;
	cmsContext context = cmsCreateContext(0, 0);
	cmsHPROFILE of = size <= UINT32_MAX ? cmsOpenProfileFromMemTHR(context, profile, (cmsUInt32Number)size) : 0;
	bool ok;
	if (!of)
		ok = err_set(err, "has a damaged colour profile: save it again, as sRGB");
	else if (cmsGetColorSpace(of) == cmsSigGrayData && !grey)
		ok = err_set(err, "has a colour profile of grey pixels on coloured ones: save it again, as sRGB");
	else if (cmsGetColorSpace(of) != cmsSigRgbData && cmsGetColorSpace(of) != cmsSigGrayData)
		ok = err_set(err, "has a colour profile of a printer or the like: convert it to sRGB");
	else
		// Grey pixels with a profile of RGB are RGB pixels of three equal values.
		ok = apply(name, rgb, n, grey && cmsGetColorSpace(of) == cmsSigGrayData, of, err);
	if (of)
		cmsCloseProfile(of);
	cmsDeleteContext(context);
	return ok;
}

/* ITU-T H.273, table 2: chromaticities of red, green, blue; all with the white point D65. */
static const struct {
	int code;
	cmsCIExyYTRIPLE rgb;
} primaries[] = {
	{ 9, { { 0.708, 0.292, 1 }, { 0.170, 0.797, 1 }, { 0.131, 0.046, 1 } } },
	{ 12, { { 0.680, 0.320, 1 }, { 0.265, 0.690, 1 }, { 0.150, 0.060, 1 } } },
};

/* Colours of such primaries and such a curve (a parametric one of the ICC's). */
static bool apply_primaries(char name[64], uint16_t *rgb, size_t n, const cmsCIExyYTRIPLE *of, int type, const double curve[], struct err *err)
{
	cmsContext context = cmsCreateContext(0, 0);
	const cmsCIExyY white = { 0.3127, 0.3290, 1 };
	cmsToneCurve *tone = cmsBuildParametricToneCurve(context, type, curve), *tones[3] = { tone, tone, tone };
	cmsHPROFILE profile = cmsCreateRGBProfileTHR(context, &white, of, tones);
	bool ok = profile && apply(name, rgb, n, false, profile, err);
	if (profile)
		cmsCloseProfile(profile);
	cmsFreeToneCurve(tone);
	cmsDeleteContext(context);
	return ok;
}

bool photo_cicp_apply(char name[64], uint16_t *rgb, size_t n, const struct photo_cicp *cicp, struct err *err)
{
	// sRGB's curve: type 4.
	static const double curve[] = { 2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045 };
	*name = 0;
	int k = -1;
	for (int i = 0; i < COUNT(primaries); i++)
		k = primaries[i].code == cicp->primaries ? i : k;
	if (k < 0)
		return true;
	if (cicp->transfer == 16 || cicp->transfer == 18)
		return err_set(err, "is a high dynamic range picture (PQ or HLG): save it as EXR, or as an ordinary photograph");
	bool ok = apply_primaries(name, rgb, n, &primaries[k].rgb, 4, curve, err);
	if (ok)
		snprintf(name, 64, "%s", primaries[k].code == 12 ? "Display P3" : "Rec. 2020");
	return ok;
}

bool photo_adobe_apply(char name[64], uint16_t *rgb, size_t n, struct err *err)
{
	// Adobe RGB (1998) Color Image Encoding, version 2005-05: primaries, and the power 2 51/256
	static const cmsCIExyYTRIPLE adobe = { { 0.64, 0.33, 1 }, { 0.21, 0.71, 1 }, { 0.15, 0.06, 1 } };
	static const double curve[] = { 2.19921875 };
	bool ok = apply_primaries(name, rgb, n, &adobe, 1, curve, err);
	if (ok)
		snprintf(name, 64, "Adobe RGB");
	return ok;
}
