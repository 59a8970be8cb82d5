# Sourced by tools/demo and tools/test, from the top of the checkout.
# install_packages GROUP...: what tools/packages.txt lists for them and is not there yet.
install_packages() {
    local wanted missing=() name sudo=()
    wanted=$(awk -v groups=" $* " '$1 !~ /^#/ && index(groups, " " $1 " ") { for (i = 2; i <= NF; ++i) print $i }' \
        tools/packages.txt)
    for name in $wanted; do
        dpkg-query -W -f '${Status}\n' "$name" 2>/dev/null | grep -q '^install ok installed$' || missing+=("$name")
    done
    [ ${#missing[@]} -eq 0 ] && return
    [ "$(id -u)" -eq 0 ] || sudo=(sudo)
    echo "installing ${missing[*]}"
    "${sudo[@]}" apt-get update -qq
    DEBIAN_FRONTEND=noninteractive "${sudo[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
}

# build FOLDER CMAKE-OPTION...: configures and builds, quietly where all goes well.
build() {
    local folder=$1
    shift
    mkdir -p "$folder"
    cmake -S . -B "$folder" -G Ninja "$@" >"$folder/configure.log" 2>&1 || { cat "$folder/configure.log" >&2; return 1; }
    ninja -C "$folder" >"$folder/build.log" 2>&1 || { grep -E -A8 'FAILED|error' "$folder/build.log" >&2; return 1; }
}
