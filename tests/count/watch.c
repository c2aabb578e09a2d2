#include "watch.h"

void count_begin(void) {
}

void count_end(void) {
}
