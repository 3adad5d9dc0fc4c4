#include "optics/sensor.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"

/* From the makers' data sheets: longer side of the effective area. A line holds for every name that begins with it; the first match
 * counts, so longer names stand before shorter ones. */
static const struct {
	const char *begins;
	double mm;
} sensors[] = {
	{ "Canon EOS 5D", 36.0 },    { "Canon EOS 6D", 35.9 },    { "Canon EOS R5", 36.0 },    { "Canon EOS R6", 35.9 },
	{ "Canon EOS R7", 22.3 },    { "Canon EOS R10", 22.3 },   { "Canon EOS RP", 35.9 },    { "Canon EOS R", 36.0 },
	{ "Canon EOS-1D X", 36.0 },  { "Canon EOS M", 22.3 },     { "Canon EOS 7D", 22.4 },    { "Canon EOS 90D", 22.3 },
	{ "Canon EOS 80D", 22.5 },   { "Canon EOS 70D", 22.5 },   { "Canon EOS 60D", 22.3 },   { "Canon EOS 50D", 22.3 },
	{ "Canon EOS 40D", 22.2 },   { "Canon EOS", 22.3 },       { "NIKON D3", 36.0 },        { "NIKON D4", 36.0 },
	{ "NIKON D5", 35.9 },        { "NIKON D6", 35.9 },        { "NIKON D7", 23.5 },        { "NIKON D8", 35.9 },
	{ "NIKON Z 50", 23.5 },      { "NIKON Z fc", 23.5 },      { "NIKON Z 30", 23.5 },      { "NIKON Z ", 35.9 },
	{ "NIKON 1 ", 13.2 },        { "ILCE-1", 35.9 },          { "ILCE-9", 35.6 },          { "ILCE-7", 35.8 },
	{ "ILCE-", 23.5 },           { "NEX-", 23.5 },            { "DSC-RX100", 13.2 },       { "DSC-RX10", 13.2 },
	{ "DSC-RX1", 35.8 },         { "DC-S", 35.6 },            { "DC-G", 17.3 },            { "DMC-G", 17.3 },
	{ "E-M", 17.3 },             { "E-PL", 17.3 },            { "OM-", 17.4 },             { "X-T", 23.5 },
	{ "X-E", 23.6 },             { "X-Pro", 23.5 },           { "X100", 23.5 },            { "GFX", 43.8 },
	{ "PENTAX K-1", 35.9 },      { "PENTAX K", 23.5 },        { "PENTAX 645", 43.8 },      { "LEICA Q", 36.0 },
};

/* Models that share their beginning with one of the table, but not their sensor. */
static const struct {
	const char *name;
	double mm;
} others[] = {
	{ "NIKON D300", 23.6 },  { "NIKON D3000", 23.6 }, { "NIKON D3100", 23.1 }, { "NIKON D3200", 23.2 },
	{ "NIKON D3300", 23.5 }, { "NIKON D3400", 23.5 }, { "NIKON D3500", 23.5 }, { "NIKON D40", 23.7 },
	{ "NIKON D5000", 23.6 }, { "NIKON D5100", 23.6 }, { "NIKON D5200", 23.5 }, { "NIKON D5300", 23.5 },
	{ "NIKON D5500", 23.5 }, { "NIKON D5600", 23.5 }, { "NIKON D50", 23.7 },   { "NIKON D500", 23.5 },
	{ "NIKON D60", 23.6 },   { "NIKON D600", 35.9 },  { "NIKON D610", 35.9 },  { "NIKON D700", 36.0 },
	{ "NIKON D750", 35.9 },  { "NIKON D780", 35.9 },  { "NIKON D80", 23.6 },   { "NIKON D90", 23.6 },
};

/* Longer side of the sensor, mm, of a camera as EXIF calls it ("Canon EOS 600D"); NAN for one that is not in the table. */
static double sensor_mm(const char *model)
{
	for (int i = 0; i < COUNT(others); i++)
		if (!strcmp(model, others[i].name))
			return others[i].mm;
	for (int i = 0; i < COUNT(sensors); i++)
		if (!strncmp(model, sensors[i].begins, strlen(sensors[i].begins)))
			return sensors[i].mm;
	return NAN;
}

double sensor_focal_px(const char *model, double focal_mm, int longer)
{
	return focal_mm / sensor_mm(model) * longer;
}
