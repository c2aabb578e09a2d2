/* Callgrind watches for the calls of these two: costs are zeroed where the first begins and dumped where the second
   does. */
#ifndef WATCH_H
#define WATCH_H

void count_begin(void);
void count_end(void);

#endif
