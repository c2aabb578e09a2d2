/* The kernels of generalised-alpha node by node (node_kinematics_lanes.c): one table for each width of vectors. */
#ifndef SPARI_NODE_KINEMATICS_KERNELS_H
#define SPARI_NODE_KINEMATICS_KERNELS_H

#include "../math/lanes.h"
#include "node_kinematics.h"

/* Passes over nodes that return the size of their motions. */
enum { SPARI_SIZED_BY_TAKE, SPARI_SIZED_BY_POSITION, SPARI_SIZED_BY_SIZE, SPARI_SIZED };

typedef struct spari_node_kernels {
    int width;
    double (*back)(const spari_node_work *t, int64_t from, int64_t to);
    void (*forth)(const spari_node_work *t, int64_t from, int64_t to);
    spari_node_size (*sized[SPARI_SIZED])(const spari_node_work *t, int64_t from, int64_t to);
    int64_t (*predict)(const spari_node_work *t, int64_t from, int64_t to);
    void (*correct)(const spari_node_work *t, int64_t from, int64_t to);
    void (*advance)(const spari_node_work *t, int64_t from, int64_t to, spari_node_size *by, spari_node_size *way);
    void (*show)(const spari_root_view *t, int64_t from, int64_t to);
    void (*look)(const spari_root_view *t, int64_t from, int64_t to);
    void (*lose)(const spari_root_jump *t, int64_t from, int64_t to);
} spari_node_kernels;

SPARI_KERNEL_TABLES(spari_node_kernels)

#endif
