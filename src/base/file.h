/* Replaces a file atomically: the new file is written under a temporary name in the same folder and renamed when
   complete. A reader finds either the old file or the new one.
   - A symbolic link is followed: its target is replaced, the link stays.
   - Of several hard links, one name gets the new file; the others keep the old one.
   - Folders, pipes, sockets, devices and files without write permission are refused.
   - Mode and owner of the old file are kept, as far as the system allows. */
#ifndef SPARI_FILE_H
#define SPARI_FILE_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

typedef struct spari_file {
    FILE *stream;            /* open for writing */
    char *place, *temporary; /* final path, and the path written to */
} spari_file;

/* Creates the temporary file.
   suffix: appended to the path to form the temporary name. An abandoned temporary file is removed; one that another
     process is writing is refused.
   Returns SPAR_OK, SPAR_ERR_IO or SPAR_ERR_MEMORY. After a failure nothing is open, and why[size] holds reason and
     remedy. */
int spari_file_begin(spari_file *file, const char *path, const char *suffix, char *why, size_t size);
/* Closes and renames the file, or removes it if writing failed. safe: synchronise with the disc before returning.
   Returns as spari_file_begin. */
int spari_file_end(spari_file *file, int safe, char *why, size_t size);
/* Closes and removes the temporary file. */
void spari_file_drop(spari_file *file);

/* "a folder", "a pipe", ...; NULL for a regular file. */
const char *spari_file_kind(unsigned mode);

#endif
