/* guard: what the kernel keeps a stage from, whatever a stranger's file makes of a decoder: reading what is not the capture's, writing
 * outside of work/, the network, other programs, memory and time without end.
 */
#ifndef BASE_GUARD_H
#define BASE_GUARD_H
#include <stdbool.h>
#include <stddef.h>

/* From here on, for this process and all that it starts:
 *   reading    below `capture`, EYEWRIGHT_SOURCE, the programs' folder and their configuration, and where the system's libraries and
 *              devices stand; where starts_programs, below the folders that those of PATH stand in; Landlock. Not a user's own files
 *   files      are written, made, renamed, removed below `work` alone (and in TMPDIR, where starts_programs); Landlock,
 *              Linux 5.19. Where work/ holds links or an attacker changes it meanwhile: the kernel follows them, and refuses.
 *   sockets    are of this machine alone; no other process is looked into, no file system mounted; libseccomp
 *   programs   are started only where starts_programs
 *   limits     address space twice the machine's memory and 16 GiB, a day of each core's time, 1024 open files
 * What the kernel does not have is left out: the checks of base/work.h and base/file.h stand without it.
 * work     path of the folder, which is there
 * capture  path of the capture's folder; null: reading is as before */
void guard_enter(const char *work, const char *capture, bool starts_programs);

/* What a process of its own is kept to, that reads strangers' bytes (base/apart.h). */
struct guard_apart {
	const char *reads;     // the one folder in which files are opened, for reading; null: none
	size_t addresses;      // bytes of address space
	size_t written;        // bytes written to a file that is open already
	long seconds;          // of processor time
};

/* From here on, for this process of one thread: no file is opened but below `reads` and for reading, none made, renamed, removed; no
 * sockets, no programs, no further processes; no core is dumped. What the kernel does not have is left out. */
void guard_apart(const struct guard_apart *limits);

#endif
