# The documents as Doxygen takes them (docs/book), and whether anything public has no words (tests/docs/names).
#   awk -f book.awk <header | document>
#   awk -v check=1 -f book.awk <header>...     prints what is not documented, exits with 1 where there is any
#
# A header's comments stand before what they are about, or behind it on its line. A prototype right under another shares its
# comment: a getter that of its setter. They are shown as they are written, with links to the calls that they name.
# In a document a link to a source becomes its name, for sources are not in the book, and headings get the names that
# links have for them.

# ---- headers

function escaped(text) {
    gsub(/\\/, "\\\\", text)
    gsub(/[<>&#%@]/, "\\\\&", text)
    gsub(/\*/, "\\&lowast;", text)
    return text
}

# The first sentence of a comment
function brief(text) {
    gsub(/[ \n]+/, " ", text)
    sub(/^ /, "", text)
    if (text ~ /^[a-z0-9_, \[\]]+: (in|out)[,. ]/ ? match(text, /\. /) : match(text, /[.:] /)) text = substr(text, 1, RSTART)
    sub(/ $/, "", text)
    sub(/:$/, ".", text)
    return escaped(text)
}

# The calls that a text names, but itself
function calls(text, self,   list, f, seen) {
    while (match(text, /spar_[a-z0-9_]+/)) {
        f = substr(text, RSTART, RLENGTH)
        text = substr(text, RSTART + RLENGTH)
        if (f == self || (f in seen) || f ~ /_$/ || f ~ /^spar_(aero|output|mpi|session|member|fluid|joint)$/) continue
        seen[f] = 1
        list = list (list == "" ? "" : ", ") f (f in CALLBACK ? "" : "()")
    }
    return list
}

# "/* text */" without its frame
function words(comment) {
    sub(/^ *\/\*/, "", comment)
    sub(/\*\/ *$/, "", comment)
    return comment
}

function document(text, self,   list) {
    list = calls(text, self)
    print "/** @brief " brief(text)
    print "@verbatim\n" text "\n@endverbatim"
    if (list != "") print "@see " list
    print "*/"
}

function missing(name) {
    print FILENAME ": " name " has no words" >"/dev/stderr"
    faults++
}

function statement(text,   name) {
    statements++
    if (text ~ /(^|\n)(typedef )?enum/) {
        enumeration(text)
        return
    }
    name = text
    if (text ~ /typedef struct/) {
        sub(/;.*/, "", name)
        sub(/.*[ \n]/, "", name)
        if (text !~ /\/\*/) missing(name)
        else if (!check) {
            match(text, /\/\*.*\*\//)
            document(words(substr(text, RSTART, RLENGTH)), name)
            print substr(text, 1, RSTART - 1)
        }
        return
    }
    if (text ~ /typedef/) {
        sub(/.*\(\*/, "", name)
        sub(/\).*/, "", name)
    } else {
        sub(/\(.*/, "", name)
        sub(/.*[ *]/, "", name)
    }
    public++
    if (own == "" && (last == "" || blank)) missing(name)
    if (own != "") last = own
    if (check) return
    document(last, name)
    print text
}

# Entries with the comment behind them; one without has the words of them all, which must be there.
function enumeration(text,   i, n, entry, line, name, comment) {
    if (!check && own != "") document(own, "")
    if (!check) print "enum {"
    sub(/^[^{]*\{/, "", text)
    gsub(/\n/, " ", text)
    while (match(text, /SPAR_[A-Z0-9_]+ *= *[0-9]+/)) {
        line = substr(text, RSTART, RLENGTH)
        text = substr(text, RSTART + RLENGTH)
        name = line
        sub(/ .*/, "", name)
        comment = ""
        if (match(text, /^ *,? *\/\*/)) {
            comment = substr(text, RSTART)
            sub(/\*\/.*/, "", comment)
            sub(/^ *,? *\/\*/, "", comment)
            gsub(/ +/, " ", comment)
            text = substr(text, index(text, "*/") + 2)
        }
        public++
        if (comment == "" && own == "") missing(name)
        if (comment == "") comment = name ~ /_COUNT$/ ? " how many this header knows " : own
        if (!check) print "    " line ", /**< " escaped(comment) " */"
    }
    if (!check) print "};"
    last = ""
}

# A comment about what follows it as a whole: a part of the page
function part(text) {
    if (check) return
    if (opened) print "/** @} */"
    if (text ~ /^ *---- /) {
        title = text
        gsub(/^ *-+ *| *-+ *$/, "", title)
        text = ""
        print "/** @name " toupper(substr(title, 1, 1)) substr(title, 2)
    } else if (title != "") print "/** @name " toupper(substr(title, 1, 1)) substr(title, 2) ": " brief(text)
    else {
        print "/** @file\n@brief " brief(text) "\n@verbatim\n" text "\n@endverbatim\n*/"
        return
    }
    if (text != "") print "@verbatim\n" text "\n@endverbatim"
    print "@{ */"
    opened = 1
}

function header(line) {
    if (in_comment || (line ~ /^\/\*/ && held == "")) {
        if (!in_comment && comment != "") part(comment)
        comment = in_comment ? comment "\n" line : line
        in_comment = line !~ /\*\/ *$/
        if (!in_comment) comment = words(comment)
        return
    }
    if (held == "" && (line ~ /^ *$/ || line ~ /^#/ || line ~ /^extern "C"|^}$/)) {
        if (comment != "") part(comment)
        comment = ""
        blank = 1
        if (!check && line ~ /^#include </) print line
        return
    }
    held = held (held == "" ? "" : "\n") line
    if (line !~ /;( *\/\*.*\*\/)?$/) return
    own = comment
    statement(held)
    held = comment = ""
    blank = 0
}

# ---- documents

function slug(text) {
    text = tolower(text)
    gsub(/[^a-z0-9 _-]/, "", text)
    gsub(/ /, "-", text)
    return text
}

# What a page's headings are called by: its name, of a README but the first its folder's
function base(path) {
    if (path ~ /^(\.\.\/)*README\.md$/ || path == ENVIRON["PWD"] "/README.md") return "README"
    sub(/\/README\.md$/, "", path)
    sub(/.*\//, "", path)
    sub(/\.md$/, "", path)
    return path
}

# [text](target): kept where the target is in the book
function link(text, target,   fragment, page, unused) {
    if (target ~ /^https?:/ || text ~ /^!/) return text "(" target ")"
    fragment = ""
    if (match(target, /#/)) {
        fragment = substr(target, RSTART + 1)
        target = substr(target, 1, RSTART - 1)
    }
    page = FILENAME
    if (!sub(/[^\/]*$/, "", page)) page = ""
    if (target !~ /\.[a-z0-9]+$/ && (getline unused < (page target "/README.md")) > 0) { # a folder with a page of its own
        close(page target "/README.md")
        target = target "/README.md"
    }
    if (fragment != "") return text "(@ref " base(target == "" ? FILENAME : target) "_" fragment ")"
    if (target ~ /\.md$/) return text "(" target ")"
    gsub(/^\[|\]$/, "", text)
    return text ~ /[\/.]/ || text ~ /`/ ? text : text " (`" base(target) "`)"
}

function document_line(line,   out, text, target) {
    if (line ~ /^#+ / && !fenced) {
        text = line
        sub(/^#+ /, "", text)
        if (line ~ /^##/ && !(text in HEADED)) line = line " {#" base(FILENAME) "_" slug(text) "}"
        HEADED[text] = 1
    }
    if (line ~ /^```/) fenced = !fenced
    if (fenced || line ~ /^    /) return line
    while (match(line, /!?\[[^]]*\]\([^) ]*\)/)) {
        out = out substr(line, 1, RSTART - 1)
        text = substr(line, RSTART, RLENGTH)
        line = substr(line, RSTART + RLENGTH)
        target = text
        sub(/.*\]\(/, "", target)
        sub(/\)$/, "", target)
        sub(/\]\([^]]*$/, "]", text)
        out = out link(text, target)
    }
    return out line
}

BEGIN { split("spar_log spar_fluid_solver spar_before_step spar_progress", names, " "); for (i in names) CALLBACK[names[i]] = 1 }
FNR == 1 { title = comment = held = last = ""; in_comment = 0; blank = 1 }
FILENAME ~ /\.md$/ { print document_line($0); next }
{ header($0) }
END {
    if (opened) print "/** @} */"
    if (check && public < 200) { print "only " public " public names found: the reading is broken"; exit 1 }
    if (check && faults) exit 1
    if (check) print public " public names have words"
}
