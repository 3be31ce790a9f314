# Sourced: installing system packages where that is possible without asking anybody.

# Succeeds if packages can be installed here.
can_install() {
    command -v apt-get >/dev/null && { [ "$(id -u)" = 0 ] || sudo -n true 2>/dev/null; }
}

install_packages() {
    local sudo=()
    [ "$(id -u)" = 0 ] || sudo=(sudo -n)
    # Another program that installs just now ends soon.
    local wait=(-o DPkg::Lock::Timeout=300)
    echo "installing $*"
    "${sudo[@]}" apt-get "${wait[@]}" update -qq &&
        "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive apt-get "${wait[@]}" install -y -qq --no-install-recommends "$@" >/dev/null
}
