/* Constants of the advice: shares of the tolerance, limits, prices. Their values are in rules.c. */
#ifndef SPARI_RULES_H
#define SPARI_RULES_H

/* Prices of the operations of a run, in instructions (cost.h), from counts of `valgrind --tool=callgrind` in the
   release build for one and two elements of 4 to 12 nodes. The cost of whole steps is right to a tenth. */
typedef struct spari_prices {
    double node, point, point_node;   /* a Newton iteration: per node, quadrature point, and node of a point */
    double pair;                      /* a tangent: per pair of nodes of an element, */
    double tangent_point;             /* per quadrature point, */
    double tangent_point_pair;        /* per pair of nodes of a point; */
    double factor, factor_row;        /* its factorisation: per unknown, per entry of its row, */
    double factor_fill;               /* per pair of these */
    double solve, solve_row;          /* back-substitution: per unknown, per entry of its row */
    double frame_node;                /* a solution of a linear or modal member: per node; */
    double product, product_row;      /* a product with one of its matrices: constant, and per entry */
    double step_node, solution_node;  /* overhead: per node in a step, and in each of its solutions */
    double column, column_pair;       /* IQN-ILS: per unknown in a column, and in a pair of columns */
    double map, map_pair;             /* transfer of motion and loads: per member node, per pair in an element, */
    double map_node, map_shape;       /* per fluid node, and per member node on which it depends */
    double fluid;                     /* the host's fluid, which cannot be counted: minimum per solution, */
    double fluid_node, fluid_section; /* per node, per blade-element section. This estimate is used */
    double believed; /* unless the measured time exceeds it by this factor: then the time in integer powers */
    double second;   /* of its square, at this many instructions per second */
} spari_prices;

/* Constants of the search. Shares are fractions of the tolerance. */
typedef struct spari_rules {
    double reference_ends;   /* dt is halved until the reference's own error is below this share, */
    double reference_most;   /* and above this share there is no reference */
    double reference_newton; /* solved with these fractions of the tolerance: for Newton, */
    double reference_rtol;   /* and for the coupling */
    double reference_nodes;  /* nodes are added until two more change less than this share, */
    double reference_fewer;  /* or removed as long as that changes less than this share, and one is added back */
    double regular[2];   /* if halving dt reduces changes by a factor between these two, the order is 2: the result is
                            extrapolated from two runs, */
    double believed;     /* by this fraction of the full extrapolation */
    double rough;        /* the structure is chosen with the coarsest dt whose error is below this many tolerances, */
    double rough_newton; /* with this fraction of the tolerance for Newton */
    double rough_rtol;   /* and this for the coupling */
    double doubt;        /* the growth of errors seen in trials is multiplied by this factor */
    double by_chance;    /* errors that grow by this factor from the second third to the last count as growing */
    double bends;        /* largest power of time of their growth */
    double foreseen;     /* beyond this many times the trials' time the trials must cover a steady state or period */
    double swells;       /* motion that grows by this factor from the second third to the last is still growing */
    double settled;      /* motion that changes by less than this fraction in the second half of the trials is steady */
    double resolves;     /* minimum number of steps in the shortest period of motion larger than the tolerance */
    double fidelity, nodes; /* shares for a lower fidelity and for fewer nodes, */
    double elements;        /* for other elements with other nodes, */
    double unknowns[2];     /* with at least this fraction of the unknowns, in fewer elements and in more, */
    double points, newton;  /* for fewer quadrature points, a looser Newton */
    double loosest_newton;  /* largest tolerance of Newton */
    double good;            /* target share of the error of good settings: the rest is for what no trial shows */
    double near;            /* within this factor of it, a finer dt is close enough; beyond it a run ends */
    double worth;           /* a change must reduce the cost below this fraction */
    double hope;            /* expected fraction of the best possible savings by another coupling */
    double heavy; /* ratio of added mass to mass above which neither explicit nor fixed-point coupling is tried */
    double worth_asking; /* moves continue as long as the search has cost less than this fraction of its savings, */
    double least_runs;  /* in a run of at least this many times the trials; no trial is made that costs more than it can
                           save there */
    double at_most;     /* a trial of a cheaper setting ends at this many times the cost to beat */
    double coarse_most; /* coarse dt of the reference are skipped if they cost more than this many trials with the
                           present session, */
    double level_most;  /* if they determine the number of nodes; otherwise this many */
    double looks_away;  /* motion larger than the reference's by this factor in the longer run is compared with a finer
                           run */
    int least_nodes;    /* per element; 2 lock */
    int most_substeps;  /* per step */
    int modes;          /* of a beam's first modal trial */
    int tried, doubted; /* maximum number of settings measured before moves end, and checked for stability; */
    int trusted;        /* number skipped if the longer run alone shows instability */
    int longer, least_steps; /* length of the longer run in trials, and its minimum number of steps, */
    double stays_newton;     /* compared with a run of half the dt: its Newton tolerance, */
    double stays_rtol;       /* and its coupling tolerance */
    double seesaw, grows; /* alternating loads: significant share of the tolerance, and growth of their square from the
                             second quarter of the longer run to the last */
    double evident;       /* square of the fraction above which alternation is certain */
    double asks;        /* expected cost of the search, divided by the root of the tolerance, in trials with the present
                           session, */
    double asks_runs;   /* and in runs if that fails: medians of benchmarks/kept */
    double comes_to[5]; /* fraction of it spent at the end of each stage (SPARI_STAGE_*), from the same */
    spari_prices price;
} spari_rules;
extern const spari_rules spari_rule;

#endif
