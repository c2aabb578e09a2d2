/* What advice goes by: shares of the tolerance, limits, prices. All its constants stand here, their values in rules.c.
 */
#ifndef SPARI_RULES_H
#define SPARI_RULES_H

/* What counts in a run cost, in instructions (cost.h). Taken from what `valgrind --tool=callgrind` counts in the
   release build, for one and two elements of 4 to 12 nodes: whole steps come out within a tenth. */
typedef struct spari_prices {
    double node, point, point_node;   /* an iteration of Newton: a node, a quadrature point, a node that it sees */
    double pair;                      /* a tangent: a pair of nodes of an element, */
    double tangent_point;             /* a quadrature point, */
    double tangent_point_pair;        /* a pair of nodes that it sees; */
    double factor, factor_row;        /* factored: an unknown, another in its row, */
    double factor_fill;               /* a pair of those */
    double solve, solve_row;          /* a linear system: an unknown, another in its row */
    double frame_node;                /* a linear or modal member's solution: a node; */
    double product, product_row;      /* a product with one of its matrices, and each entry */
    double step_node, solution_node;  /* beside all this: a node in a step, and in each solution of it */
    double column, column_pair;       /* IQN-ILS: an unknown in a column, and in a pair of columns */
    double map, map_pair;             /* motion and loads of a fluid: a node of the member, a pair in an element, */
    double map_node, map_shape;       /* a node of the fluid, each of the member's that it is tied to */
    double fluid;                     /* the host's fluid, which cannot be counted: a solution at least, */
    double fluid_node, fluid_section; /* for each node, for each section of blade elements. That is believed, */
    double believed;                  /* unless the time taken is so many times as much: then that in whole powers */
    double second;                    /* of the square of it, at so many instructions a second */
} spari_prices;

/* What advice goes by. Shares are parts of the tolerance. */
typedef struct spari_rules {
    double reference_ends;   /* dt is halved until the reference's own error is below this share, */
    double reference_most;   /* and above this one there is no reference */
    double reference_newton; /* with what it is solved, of the tolerance: Newton's, */
    double reference_rtol;   /* and the coupling's */
    double reference_nodes;  /* nodes are added until two more change less than this share, */
    double reference_fewer;  /* or left out as long as that changes less than this one, and one is put back */
    double regular[2];       /* changes that fall by factors between these two as dt is halved are of order 2: what two
                                runs point to is then believed, but for */
    double believed;         /* this part of the way there */
    double rough;            /* the structure is chosen with the coarsest dt whose error is below so many tolerances, */
    double rough_newton;     /* with what of the tolerance for Newton's */
    double rough_rtol;       /* and for the coupling's */
    double doubt;            /* so many times as much as trials show of their errors' growth is reckoned with */
    double by_chance;        /* errors that are so many times as large in the last third as in the one before grow */
    double bends;            /* the power of time that they grow by at most */
    double foreseen;         /* beyond so many times the trials' time they must have shown what goes on */
    double swells;   /* motion that is so many times as large in the last third as in the one before still grows */
    double settled;  /* motion that in the second half of the trials changes by less than this part goes on so */
    double resolves; /* steps in the shortest period of what moves by more than the tolerance, at least */
    double fidelity, nodes; /* shares that a lower fidelity and fewer nodes may take, */
    double elements;        /* other elements in place of those, with nodes of their own, */
    double unknowns[2];     /* and so much of the unknowns at least, in fewer elements and in more, */
    double points, newton;  /* fewer quadrature points, a looser Newton */
    double loosest_newton;  /* its tolerance goes no further */
    double good;            /* share that the error of good settings is below: the rest is for what no trial shows */
    double near;            /* times that: a finer dt is near that will do; beyond it a run ends */
    double worth;           /* a change has to bring the cost below this part of it */
    double hope;            /* of what another coupling could save at best this part is expected */
    double heavy;           /* added mass over mass from which on neither explicit nor fixed-point coupling is tried */
    double worth_asking;    /* moves are tried as long as asking has cost less than this part of what has been saved, */
    double least_runs;      /* in a run of so many times the trials at least; no trial is made that cannot save as much
                               there as it costs */
    double at_most;         /* what is tried because it may be cheaper ends at so many times the cost to beat */
    double coarse_most;     /* the coarse dt of the reference are left out from so many trials as the session is on, */
    double level_most;      /* where they show how many nodes it has; and else from so many on */
    double looks_away;      /* motion that in the longer look is more than so many times what the reference has is
                               looked at beside a finer run */
    int least_nodes;        /* of an element; 2 lock */
    int most_substeps;      /* in a step */
    int modes;              /* that a beam's first modal try has */
    int tried, doubted;     /* settings measured before moves end, and whose stability is looked at, at most; */
    int trusted;            /* so many are passed over where a look alone finds them unstable */
    int longer, least_steps; /* that is looked at in a run so many times as long, and of so many steps at least, */
    double stays_newton;     /* against one of half the dt: with what that is solved, */
    double stays_rtol;       /* and coupled */
    double seesaw, grows;    /* loads that turn round with every step: the share of the tolerance that counts, and their
                                growth, squared, from the second quarter of the longer look to the last */
    double evident;          /* part of its square from which on the saw-tooth is beyond doubt */
    double asks;        /* what asking comes to, by the root of the tolerance, in trials with the session as it is, */
    double asks_runs;   /* and in runs where that fails: medians of benchmarks/kept */
    double comes_to[5]; /* the part of it that is spent by the end of each stage (SPARI_STAGE_*), as there */
    spari_prices price;
} spari_rules;
extern const spari_rules spari_rule;

#endif
