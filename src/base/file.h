/* A file that is replaced whole: it is written under a temporary name beside its place, and renamed when all of it is
   there, so that a reader finds the old one or the new one, whatever happens. Of a symbolic link the end is replaced,
   and the link stays; of hard links one name gets the new file, the others keep the old one. What is no file (a folder,
   a pipe, a socket, a device) and what this process may not write to is refused. Mode and owner stay those of the file
   that was there, as far as the system allows. */
#ifndef SPARI_FILE_H
#define SPARI_FILE_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

typedef struct spari_file {
    FILE *stream;            /* to be written to */
    char *place, *temporary; /* where it is going to be, and where it is */
} spari_file;

/* suffix: of the temporary name. What a process that was killed has left there goes; where one is still at work it is
   refused. Return SPAR_OK, SPAR_ERR_IO, SPAR_ERR_MEMORY with the reason and the cure in why[size]; nothing is open
   then. */
int spari_file_begin(spari_file *file, const char *path, const char *suffix, char *why, size_t size);
/* Closes and renames; or, after a failure of this or of what was written, removes. safe: on the disc before it answers.
   Answers as above. */
int spari_file_end(spari_file *file, int safe, char *why, size_t size);
/* Bytes of a file that is being written into its temporary one, or from it, by another process than the one that began
   it: where no other writes, and on the disc when it answers. Answer as above. */
int spari_file_put_part(const char *temporary, int64_t offset, const void *data, size_t n, char *why, size_t size);
int spari_file_get_part(const char *temporary, int64_t offset, void *data, size_t n, char *why, size_t size);
/* For a while others may lock it; hold: again nobody but this process, before the end. 0: another process has it. */
void spari_file_release(spari_file *file);
int spari_file_hold(spari_file *file);
/* Closes and removes instead. */
void spari_file_drop(spari_file *file);

/* "a folder", "a pipe", ...; NULL: a file. */
const char *spari_file_kind(unsigned mode);

#endif
