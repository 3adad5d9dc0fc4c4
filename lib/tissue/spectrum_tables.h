/* spectrum_tables: what the CIE publishes as numbers (CIE 15). */
#ifndef TISSUE_SPECTRUM_TABLES_H
#define TISSUE_SPECTRUM_TABLES_H

/* Daylight components S0, S1, S2 from 380 to 780 nm in steps of 10. */
extern const double spectrum_daylight[3][41];

/* Fluorescent lamps F2 and F11, 380 to 780 nm in steps of 5. */
extern const double spectrum_f2[81], spectrum_f11[81];

#endif
