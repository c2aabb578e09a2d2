# The plain procedures of the module spar from the table of interface.awk (with null=1): those whose arguments are C's, checked.
# What takes thought is by hand in fortran/spar.f90.in; a call that appears there is left to it.
#   awk -v file=<its name> -f plain.awk <fortran/spar.f90.in> <table>
# Out comes the file with each line "! plain procedures of <object>" replaced by them, and each "! plain bindings of <object>"
# in the type by theirs, unless the file binds them itself.
#
# An argument is optional where the header says what NULL means, an output where it has others beside it. The argument n comes from
# the first array that must be there; other sizes are counts of the object, by the header's names for them. Numbers of C that can be
# only 0 or 1 bear the name `on`, and are logical here.

# "text" in lines of at most 120 columns, cut behind commas and brackets
function put(indent, text,   line, cut) {
    line = indent text
    while (length(line) > 120) {
        for (cut = 118; substr(line, cut - 1, 2) !~ /[,)] /; cut--) ;
        add(substr(line, 1, cut - 1) " &")
        line = indent "    " substr(line, cut + 1)
    }
    add(line)
}

function add(line) { made = made line "\n" }

function extent(text) { return text ~ /^[0-9]+$/ ? text "_c_int64_t" : text }

# "[n][3]" as Fortran's EXTENT[1..RANK], the last of C first; 36 is a 6x6 matrix
function measure(shape,   k, part, i) {
    gsub(/^\[|\]$/, "", shape)
    RANK = 0
    k = shape == "" ? 0 : split(shape, part, /\]\[/)
    for (i = k; i >= 1; i--) {
        if (part[i] == "36") EXTENT[++RANK] = "6"
        EXTENT[++RANK] = part[i] == "36" ? "6" : part[i]
    }
}

function is_fixed(   i) {
    for (i = 1; i <= RANK; i++) if (EXTENT[i] !~ /^[0-9]+$/) return 0
    return 1
}

function dimensions(   i, text) {
    for (i = 1; i <= RANK; i++) text = text (i > 1 ? "," : "") (is_fixed() ? EXTENT[i] : ":")
    return RANK ? "(" text ")" : ""
}

# What an array's extents must be
function needed(   i, text, e) {
    for (i = 1; i <= RANK; i++) {
        e = EXTENT[i]
        if (object == "aero") e = e ~ /^(sections|blades)$/ ? "self%" e : extent(e)
        else e = e == "n" || e ~ /nodes$/ ? count : extent(e)
        text = text (i > 1 ? ", " : "") e
    }
    return "[" text "]"
}

# What cannot be made by these rules is written by hand.
function cannot(why) {
    print "plain.awk: " $2 ": " why ": write it by hand in " file >"/dev/stderr"
    failed = 1
}

function begin(   i, part) {
    object = name = $2
    split($4, part, "|")
    object = part[2]
    sub(/^spar_/, "", name)
    if (name !~ /^step_/) sub(/^[a-z]+_/, "", name)
    title = object "%" name
    procedure = object "_" name
    outs = 0
    params = NF - 4
    for (i = 1; i <= params; i++) {
        split($(i + 4), part, "|")
        P[i] = part[1]; TYPE[i] = part[2]; PASS[i] = part[3]; SHAPE[i] = part[4]
        MAYBE[i] = part[5] == "null"
        if (PASS[i] == "out") outs++
        if (PASS[i] == "callback" || PASS[i] == "list" || TYPE[i] == "context" || !(TYPE[i] in KIND) && TYPE[i] != "char")
            cannot("an argument of the type " TYPE[i])
    }
    for (i = 1; i <= params; i++) if (PASS[i] == "out") MAYBE[i] = outs > 1
}

# Where n comes from: COUNTED, the parameter that has it, hidden; count, the text for it; asked, a call that is made for it
function find_count(   i, has) {
    COUNTED = 0; count = asked = carrier = ""
    for (i = 1; i <= params; i++) {
        if (TYPE[i] == "int64_t" && PASS[i] == "value" && (P[i] == "n" || P[i] == "capacity")) COUNTED = i
        measure(SHAPE[i])
        if (RANK && !is_fixed() && TYPE[i] != "char") has = 1
    }
    if (!has || object == "aero") return
    if (!COUNTED) {
        count = "n"
        if (object == "member") asked = "spar_member_get_count(self%handle, n)"
        else if (object == "fluid") asked = "spar_fluid_get_count(self%handle, " nodes() ", n)"
        else cannot("nothing that says how many")
        return
    }
    for (i = 1; i <= params && count == ""; i++) {
        measure(SHAPE[i])
        if (!RANK || MAYBE[i] || TYPE[i] == "char") continue
        if (P[COUNTED] == "capacity" ? RANK == 1 && PASS[i] == "out" && outs == 1 : EXTENT[RANK] == "n") {
            carrier = P[i]
            count = "size(" P[i] (RANK > 1 ? ", " RANK : "") ", kind=c_int64_t)"
        }
    }
    if (count == "") cannot("no array that says how many")
}

function nodes(   i) {
    for (i = 1; i <= params; i++) {
        if (SHAPE[i] ~ /\[which_nodes\]/) return "to_c(which)"
        if (SHAPE[i] ~ /\[force_nodes\]/) return "to_c(SPAR_NODES_FORCE)"
        if (SHAPE[i] ~ /\[motion_nodes\]/) return "to_c(SPAR_NODES_MOTION)"
    }
    cannot("no set of nodes")
}

function declare(i,   type) {
    measure(SHAPE[i])
    if (TYPE[i] == "char") return "character(*), intent(in) :: " P[i]
    type = P[i] == "on" ? "logical" : TYPE[i] == "int" ? "integer" : KIND[TYPE[i]]
    if (RANK && !is_fixed()) type = type ", contiguous"
    type = type ", intent(" (PASS[i] == "out" ? "inout" : "in") ")" (MAYBE[i] ? ", optional" : "")
    return type " :: " P[i] dimensions()
}

function actual(i) {
    if (i == COUNTED) return count
    if (TYPE[i] == "char") return "c_text(" P[i] ")"
    if (TYPE[i] == "int" && PASS[i] == "value") return (P[i] == "on" ? "flag(" : "to_c(") P[i] ")"
    if (TYPE[i] == "int") return "c_" P[i]
    return P[i]
}

# The shapes that arrays must have, as calls of need
function checks(   i, has, line, triples) {
    for (i = 1; i <= params; i++) {
        measure(SHAPE[i])
        if (!RANK || is_fixed() || TYPE[i] == "char" || P[COUNTED] == "capacity" || P[i] == carrier && RANK == 1) continue
        if (TYPE[i] == "int" || TYPE[i] == "int64_t") cannot("an array of integers")
        triples = object == "fluid" && name ~ /^(pull|push)_/ && SHAPE[i] ~ /_nodes\]\[3\]$/
        line = "shape(" P[i] ", kind=c_int64_t), "
        line = triples ? "need_triples(self, " which_nodes() ", fault, '" P[i] "', " line "n)" : \
            "need(fault, '" P[i] "', " line needed() ")"
        CHECK[++has] = (MAYBE[i] ? "if (present(" P[i] ")) " : "") "call " line
    }
    return has
}

function which_nodes(   text) {
    text = nodes()
    gsub(/^to_c\(|\)$/, "", text)
    return text
}

function head(   i, names, line) {
    for (i = 1; i <= params; i++) if (i != COUNTED) names = names ", " P[i]
    put("  ", "recursive subroutine " procedure "(self" names ", stat, errmsg)")
    add("    class(spar_" object (object == "aero" ? "_object" : "") "), intent(" (name ~ /^(get|pull|write|save|fail)(_|$)/ ? "in" : "inout") ") :: self")
    for (i = 1; i <= params; i++) {
        if (i == COUNTED) continue
        FORM = declare(i)
        if (split(line, part, " :: ") == 2 && split(FORM, side, " :: ") == 2 && part[1] == side[1]) line = line ", " side[2]
        else {
            if (line != "") put("    ", line)
            line = FORM
        }
    }
    if (line != "") put("    ", line)
    add("    integer, intent(out), optional :: stat")
    add("    character(*), intent(inout), optional :: errmsg")
}

function body(   i, has, session, line, locals, hands) {
    session = object == "session" ? "self%handle" : object == "polar" ? "c_null_ptr" : "self%session"
    has = checks()
    for (i = 1; i <= params; i++) {
        if (TYPE[i] == "int" && PASS[i] == "out") { locals = locals ", c_" P[i]; hands++ }
        line = line ", " actual(i)
    }
    if (asked != "") add("    integer(c_int64_t) :: n")
    if (has) add("    character(:), allocatable :: fault")
    if (asked != "" || hands) put("    ", "integer(c_int) :: status" locals)
    add("")
    if (asked != "") {
        add("    status = " asked)
        add("    if (status /= SPAR_OK) then\n      call finish(status, " session ", stat, errmsg)\n      return\n    end if")
    }
    for (i = 1; i <= has; i++) put("    ", CHECK[i])
    if (has) {
        add("    if (allocated(fault)) then\n      call refuse('" title "', fault, stat, errmsg" (object ~ /member|fluid/ ? ", self%name" : "") ")")
        add("      return\n    end if")
    }
    line = $2 "(self%handle" line ")"
    if (!hands) {
        put("    ", "call finish(" line ", " session ", stat, errmsg)")
        return
    }
    put("    ", "status = " line)
    for (i = 1; i <= params; i++)
        if (TYPE[i] == "int" && PASS[i] == "out")
            add(P[i] == "on" ? "    if (status == SPAR_OK) on = c_on /= 0" : "    call hand(status, c_" P[i] ", " P[i] ")")
    add("    call finish(status, " session ", stat, errmsg)")
}

BEGIN {
    FS = "\t"
    KIND["int"] = "integer"
    KIND["int64_t"] = "integer(c_int64_t)"
    KIND["double"] = "real(c_double)"
    KIND["float"] = "real(c_float)"
}

FNR == NR {
    LINE[++lines] = $0
    text = $0
    sub(/!.*/, "", text)
    while (match(text, /(spar|c)_[a-z0-9_]+\(/)) {
        BY_HAND[substr(text, RSTART, RLENGTH - 1)] = 1
        text = substr(text, RSTART + RLENGTH)
    }
    if (match($0, /=> .*/)) BOUND = BOUND substr($0, RSTART + 2) ","
    next
}

$1 == "call" {
    if ($2 in BY_HAND || $2 ~ /^spar_(member|trial)_get_session$/) next # a session has one variable, which owns it
    f = $2
    sub(/^spar_/, "c_", f)
    sub(/^c_vtk_/, "c_", f)
    if (f in BY_HAND || $3 != "int" || NF < 4) next
    begin()
    find_count()
    made = ""
    head()
    body()
    add("  end subroutine " procedure)
    PROCEDURES[object] = PROCEDURES[object] "\n" made
    if (BOUND !~ " " procedure ",") BINDINGS[object] = BINDINGS[object] "    procedure :: " name " => " procedure "\n"
}

END {
    if (failed) exit 1
    for (i = 1; i <= lines; i++) {
        object = LINE[i]
        sub(/.* /, "", object)
        if (LINE[i] ~ /^ *! plain procedures of [a-z]+$/) printf "  ! Written by cmake/make-bindings.sh.\n%s", PROCEDURES[object]
        else if (LINE[i] ~ /^ *! plain bindings of [a-z]+$/) printf "%s", BINDINGS[object]
        else print LINE[i]
    }
}
