# What the instruments of tests/ know of every call, from the table of interface.awk (with null=1).
#   awk -v pass=names -f calls.awk <table>              tests/torture/calls.h: local and collective calls by name
#   awk -v pass=fuzz|table -f calls.awk <list> <table>  tests/torture/fuzz/calls_plain.c and .h: callers with arguments drawn by their
#                                                       types, of the calls that are not in the list of those written by hand
#   awk -v pass=bindings -f calls.awk <table>           tests/fortran/test_bindings.f90, its calls: each raw binding once, with no object

function put(text) { print text }

# ---- the fuzzer ----

# How many numbers an array has: of its own dimensions, of arguments, or enough for any object of the fuzzer
function numbers(shape, type,   k, part, i, text, d) {
    gsub(/^\[|\]$/, "", shape)
    if (shape == "") return (("capacity" in COUNT) && type == "char") ? "length(capacity)" : "1"
    k = split(shape, part, /\]\[/)
    for (i = 1; i <= k; i++) {
        d = part[i] ~ /^[0-9]+$|^SPAR_/ ? part[i] : (part[i] in COUNT) ? "length(" part[i] ")" : "FUZZ_ENOUGH"
        text = text (text == "" ? "" : " * ") d
    }
    return text
}

function caller(   i, part, p, type, how, shape, null, given, line, n) {
    split("", COUNT)
    for (i = 4; i <= NF; i++) {
        split($i, part, "|")
        if (part[2] == "int64_t" && part[3] == "value") COUNT[part[1]] = 1
    }
    put("\nvoid do_" $2 "(call *c) {")
    for (i = 4; i <= NF; i++) {
        split($i, part, "|")
        p = part[1]; type = part[2]; how = part[3]; shape = part[4]; null = part[5] == "null"
        given = p
        line = ""
        n = numbers(shape, type)
        if (type == "session" && how == "value") { line = "live_session *" p " = arg_session(c);"; given = p "->s" }
        else if (type == "member" && how == "value") { line = "live_member *" p " = arg_member(c, " ($2 ~ /^spar_beam/ ? "KIND_BEAM" : "-1") ");"; given = p "->m" }
        else if (type == "joint" && how == "value") { line = "live_joint *" p " = arg_joint(c, JOINT_ANY);"; given = p "->j" }
        else if (type == "fluid" && how == "value") { line = "live_fluid *" p " = arg_fluid(c);"; given = p "->f" }
        else if (type == "aero" && how == "value") { line = "live_aero *" p " = arg_aero(c);"; given = p "->a" }
        else if (type == "polar" && how == "value") line = "spar_polar *" p " = arg_polar(c);"
        else if (how == "value" && type == "double") line = "double " p " = arg_real(c, 0, 1);"
        else if (how == "value" && type == "int") line = "int " p " = arg_int(c, 0, " (p == "on" ? 1 : 3) ");"
        else if (how == "value" && type == "int64_t") line = "int64_t " p " = arg_count(c, 0, 4);"
        else if (how == "in" && type == "char") line = "const char *" p " = arg_name(c, \"x\");"
        else if (how == "in" && type == "double") line = "double *" p " = arg_reals" (null ? "_or_null" : "") "(c, " n ", -1, 1);"
        else if (how == "in" && type == "float") line = "float *" p " = arg_floats(c, " n ", -1, 1, " null + 0 ");"
        else if (type == "char") line = "char *" p " = arg_out(c, " n ", " null + 0 ");"
        else if (type in NUMBER) line = type " *" p " = arg_out(c, " (n == "1" ? "" : n " * ") "(int64_t)sizeof *" p ", " null + 0 ");"
        else given = "NULL"
        if (line != "") put("    " line)
    }
    line = ""
    for (i = 4; i <= NF; i++) {
        split($i, part, "|")
        p = part[1]; type = part[2]; how = part[3]
        given = how == "value" && type ~ /^(session|member|joint|fluid|aero)$/ ? p "->" (substr(type, 1, 1)) : p
        if (!(type in NUMBER) && type != "char" && !(how == "value" && type ~ /^(session|member|joint|fluid|aero|polar)$/)) given = "NULL"
        line = line (i > 4 ? ", " : "") given
    }
    if ($3 == "int") put("    RUN(c, " $2 "(" line "));")
    else if ($3 == "text") put("    RUN_VOID(c, is_text(" $2 "(" line ")));")
    else put("    RUN_VOID(c, " $2 "(" line "));")
    put("}")
}

function flags() {
    if ($3 != "int") return "FUZZ_TEXT | FUZZ_PURE"
    return $2 ~ /_(get|evaluate|check|estimate|pull)_|_evaluate$/ ? "FUZZ_PURE" : "FUZZ_CHANGES"
}

# ---- the raw bindings of Fortran ----

# A call with nothing: no handles, zeros, and the other arguments left out. It is refused, but for the few that need nothing.
function binding(   i, part, line, skipped, text, expected) {
    for (i = 4; i <= NF; i++) {
        split($i, part, "|")
        text = ""
        if (part[3] == "callback") text = "c_null_funptr"
        else if (part[3] == "value" && part[2] == "int") text = "0_c_int"
        else if (part[3] == "value" && part[2] == "int64_t") text = "0_c_int64_t"
        else if (part[3] == "value" && part[2] == "double") text = "0.0_c_double"
        else if (part[3] == "value") text = "none"
        else if (part[3] == "out" && !(part[2] in NUMBER) && part[2] != "char") text = "made"
        if ($2 == "spar_session_create_fcomm" && text == "0_c_int") text = "-1_c_int" # 0 may be the world's
        if (text == "") { skipped = 1; continue }
        line = line (line == "" ? "" : ", ") (skipped ? part[1] "=" : "") text
    }
    line = $2 "(" line ")"
    if ($3 == "none") {
        wrap("made = c_null_ptr")
        sub(/\(none\)/, "(made)", line)
        wrap("call " line)
        return
    }
    expected = $3 == "text" ? "c_associated(" line ")" : ""
    if ($2 == "spar_has") expected = line " == 0"
    if ($2 == "spar_session_create_fcomm") expected = line " /= SPAR_OK .and. .not. c_associated(made)"
    if ($2 == "spar_session_create" || $2 == "spar_aero_create") expected = line " == SPAR_OK .and. c_associated(made)"
    if (expected != "") wrap("call check(" expected ", '" $2 "')")
    else wrap("call refused(" line ", '" $2 "')")
    if (expected ~ /OK .and. c_assoc/) { # and is not left behind
        sub(/_create$/, "_destroy", $2)
        wrap("call " $2 "(made)")
    }
}

# in lines of at most 120 columns, cut behind commas and brackets
function wrap(text,   line, cut) {
    line = "  " text
    while (length(line) > 118) {
        for (cut = 116; substr(line, cut - 1, 2) !~ /[,)] /; cut--) ;
        print substr(line, 1, cut - 1) " &"
        line = "      " substr(line, cut + 1)
    }
    print line
}

BEGIN {
    FS = "\t"
    NUMBER["double"] = NUMBER["float"] = NUMBER["int"] = NUMBER["int64_t"] = 1
}
(pass == "fuzz" || pass == "table") && FNR == NR { BY_HAND[$1] = 1; next }
$1 == "call" && pass == "names" { NAME[++names] = $2; next }
$1 == "collective" && pass == "names" { COLLECTIVE[$2] = 1; next }
$1 == "call" && pass == "fuzz" && !($2 in BY_HAND) { caller(); next }
$1 == "call" && pass == "table" && !($2 in BY_HAND) { printf " \\\n    CALL(%s, 30, %s)", $2, flags(); next }
$1 == "call" && pass == "bindings" { binding() }

function list(macro, collective,   i, line) {
    print "#define " macro "(CALL) \\"
    for (i = 1; i <= names; i++)
        if ((NAME[i] in COLLECTIVE) == collective) {
            if (line != "") print line " \\"
            line = "    CALL(" NAME[i] ")"
        }
    print line
}

END {
    if (pass == "names") {
        list("SPAR_LOCAL_CALLS", 0)
        list("SPAR_COLLECTIVE_CALLS", 1)
    }
    if (pass == "table") printf "\n"
}
