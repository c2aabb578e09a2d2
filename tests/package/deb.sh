#!/bin/sh
# deb.sh <source> <build> <work> <cpack> <compiler> <release> <number of the ABI> <that of libspar_aero>: the four Debian packages,
# unpacked side by side, are an installation that a host builds and runs with; each has its files, its licence, and says what it
# needs.
set -eu
source=$1 build=$2 work=$3 cpack=$4 compiler=$5 release=$6 soversion=$7 aero=libspar-aero$8
rm -rf "$work"
mkdir -p "$work/root"
# the book goes into spar-doc where it was made
made=
if command -v pandoc >/dev/null 2>&1 && [ ! -d "$build/book" ]; then
    made=$build/book
    trap 'rm -rf "$made"' EXIT
    "$source/docs/book" "$build/book" >"$work/book.log" 2>&1 || { tail -n 20 "$work/book.log"; exit 1; }
fi
"$cpack" -G DEB --config "$build/CPackConfig.cmake" -B "$work" >"$work/cpack.log" 2>&1 || { cat "$work/cpack.log"; exit 1; }
for package in "libspar$soversion" "$aero" libspar-dev spar-doc; do
    file=$(find "$work" -maxdepth 1 -name "${package}_${release}_*.deb")
    [ -n "$file" ] || { echo "no $package of release $release"; ls "$work"; exit 1; }
    [ "$(dpkg-deb -f "$file" Package)" = "$package" ]
    dpkg-deb -c "$file" | sed 's, -> .*,,; s,.* \./,,' | grep -v '/$' >"$work/$package.files"
    grep -q "usr/share/doc/$package/copyright" "$work/$package.files" || { echo "$package has no licence"; exit 1; }
    dpkg-deb -x "$file" "$work/root"
    echo "$package: $(wc -l <"$work/$package.files") files; needs $(dpkg-deb -f "$file" Depends)"
done
# nothing is in two packages, and nothing that an installation has is in none
sort "$work"/*.files | uniq -d >"$work/twice"
[ ! -s "$work/twice" ] || { echo "in two packages:"; cat "$work/twice"; exit 1; }
[ "$(grep -v /doc/ "$work/libspar$soversion.files" | grep -vE 'lib/libspar\.so\.[0-9.]+$|lib/[a-z0-9_-]+/libspar\.so\.[0-9.]+$')" = "" ]
if [ -d "$build/book" ]; then
    for page in index reference-spar reference-spar_aero reference-spar_output reference-spar_mpi explanation-theory; do
        grep -q "/html/$page\.html$" "$work/spar-doc.files" || { echo "spar-doc has no page $page of the book"; exit 1; }
    done
    # every picture and page that the first page leads to is there
    html=$(dirname "$(find "$work/root" -path '*/html/index.html')")
    grep -oE '(href|src)="[^":#?]+["#]' "$html/index.html" | sed 's/^[^"]*"//; s/["#]$//' | sort -u | while read -r file; do
        [ -e "$html/$file" ] || { echo "spar-doc: index.html leads to $file, which is not there"; exit 1; }
    done
fi
[ "$(grep -v /doc/ "$work/$aero.files" | grep -vE 'libspar_aero\.so\.[0-9.]+$')" = "" ]
dpkg-deb -f "$work/$aero"_*.deb Depends | grep -q "libspar$soversion (= $release)"
dpkg-deb -f "$work"/libspar"$soversion"_*.deb Depends | grep -q libgsl
dpkg-deb -f "$work"/libspar-dev_*.deb Depends | grep -q "libspar$soversion (= $release)"
sh "$source/tests/package/pkgconfig.sh" "$work/root/usr" "$work/consumer" "$compiler" "$source/tests/package/c/main.c" spar
sh "$source/tests/package/pkgconfig.sh" "$work/root/usr" "$work/aero_consumer" "$compiler" "$source/tests/package/aero/main.c" spar_aero
rm -rf "$work/_CPack_Packages"
