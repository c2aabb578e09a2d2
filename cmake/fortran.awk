# The table of interface.awk as Fortran.
#   awk -v pass=calls|constants|names -v title=<the header's name> -f fortran.awk <table>
#   calls: an interface for each; constants: as integer(c_int); names: in the default kind of integer, public

# "text" in lines of at most 120 columns, cut behind commas and brackets
function put(indent, text,   line, cut) {
    line = indent text
    while (length(line) > 120) {
        for (cut = 118; substr(line, cut - 1, 2) !~ /[,)] /; cut--) ;
        print substr(line, 1, cut - 1) " &"
        line = indent "    " substr(line, cut + 1)
    }
    print line
}

function open_part(indent) {
    if (!started++) print indent "! " title
    else if (pass == "calls") print ""
}

# A parameter's declaration without its name; NAME[i] has that, with the shape.
function declared(i, p, type, how, shape) {
    NAME[i] = p
    if (how == "callback") return "type(c_funptr), value"
    if (how == "list") {
        NAME[i] = p "(*)"
        return "type(c_ptr), intent(in), optional"
    }
    if (!(type in KIND)) return how == "out" ? "type(c_ptr), intent(inout), optional" : "type(c_ptr), value"
    if (how == "value") return KIND[type] ", value"
    if (shape ~ /^\[[0-9]+\]$/) NAME[i] = p "(" substr(shape, 2, length(shape) - 2) ")"
    else if (shape != "") NAME[i] = p "(*)"
    return KIND[type] ", intent(" (how == "in" ? "in" : "inout") "), optional"
}

# which kinds a declaration takes from its surroundings
function needs(text,   k) {
    for (k = 1; k <= KINDS; k++)
        if (index(text, ORDER[k] ")")) NEED[ORDER[k]] = 1
}

BEGIN {
    FS = "\t"
    KIND["int"] = "integer(c_int)"
    KIND["int64_t"] = "integer(c_int64_t)"
    KIND["double"] = "real(c_double)"
    KIND["float"] = "real(c_float)"
    KIND["char"] = "character(kind=c_char)"
    KINDS = split("c_char c_double c_float c_funptr c_int c_int64_t c_ptr", ORDER, " ")
}

$1 == "constants" && pass != "calls" {
    line = ""
    for (i = 2; i <= NF; i++) {
        split($i, side, "=")
        line = line (i > 2 ? ", " : "") side[1] " = " side[2]
    }
    if (pass == "constants") open_part("  ")
    put("  ", (pass == "names" ? "integer, parameter, public" : "integer(c_int), parameter") " :: " line)
}

$1 == "call" && pass == "calls" {
    f = $2
    result = $3 == "none" ? "" : $3 == "text" ? "text" : "status"
    answer = $3 == "text" ? "type(c_ptr)" : "integer(c_int)"
    names = ""
    split("", NEED)
    for (i = 4; i <= NF; i++) {
        split($i, part, "|")
        FORM[i] = declared(i, part[1], part[2], part[3], part[4])
        needs(FORM[i])
        names = names (i > 4 ? ", " : "") part[1]
        if (part[1] == result) result = "answer"
    }
    if (result != "") needs(answer)
    imports = ""
    for (i = 1; i <= KINDS; i++)
        if (ORDER[i] in NEED) imports = imports (imports == "" ? "" : ", ") ORDER[i]

    open_part("    ")
    put("    ", (result == "" ? "subroutine " : $3 == "text" ? "pure function " : "function ") f "(" names ") bind(c)" (result == "" ? "" : " result(" result ")"))
    print "      import :: " imports
    for (i = 4; i <= NF; i++) { # neighbours of one kind share a line
        line = i > 4 && FORM[i] == FORM[i - 1] ? line ", " NAME[i] : FORM[i] " :: " NAME[i]
        if (i == NF || FORM[i + 1] != FORM[i]) put("      ", line)
    }
    if (result != "") print "      " answer " :: " result
    print "    end " (result == "" ? "subroutine " : "function ") f
}
