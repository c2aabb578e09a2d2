/* The threads of a host that has started none, after the library was loaded and used: one. */
#include <spar/spar.h>

#include <dirent.h>
#include <stdio.h>

int main(void) {
    spar_session *session = NULL;
    int threads = 0, status = spar_session_create(&session);
    DIR *tasks = opendir("/proc/self/task");
    for (struct dirent *task = tasks ? readdir(tasks) : NULL; task; task = readdir(tasks)) {
        threads += task->d_name[0] != '.';
    }
    if (tasks) {
        (void)closedir(tasks);
    }
    spar_session_destroy(&session);
    printf("%d thread(s)\n", threads);
    return status != SPAR_OK || threads != 1;
}
