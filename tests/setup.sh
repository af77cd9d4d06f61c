# Sourced by run.sh here and in demos: installs what is missing of Debian's packages, and nothing if nothing is.

pintle_install_packages() {  # more packages
  command -v dpkg-query >/dev/null || return 0 # no Debian: CMake says what it misses

  local missing=() package
  for package in cmake g++ make libbullet-dev libeigen3-dev libgtest-dev libbenchmark-dev libcli11-dev "$@"; do
    # A tool may come from elsewhere.
    command -v "$package" >/dev/null ||
      dpkg-query --show --showformat='${db:Status-Status}\n' "$package" 2>/dev/null | grep -qx installed ||
      missing+=("$package")
  done
  [ ${#missing[@]} -gt 0 ] || return 0

  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    as_root=(sudo)
    # Without a terminal nobody can type a password.
    if ! { sudo -n true || { [ -t 0 ] && sudo true; }; } 2>/dev/null; then
      echo "Missing packages, and no rights to install them: ${missing[*]}" >&2
      exit 1
    fi
  fi
  echo "Installing ${missing[*]}"
  "${as_root[@]}" apt-get update
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "${missing[@]}"
}

# Without them a few things are left out, and no more is lost.
pintle_install_optional_packages() {  # packages
  (pintle_install_packages "$@") || echo "Without $*: what needs them is left out" >&2
}

# What the page needs: Node, from wherever it comes. And more packages.
pintle_install_page_packages() {
  local packages=("$@")
  { command -v node && command -v npm; } >/dev/null || packages+=(nodejs npm)
  pintle_install_optional_packages ${packages[@]+"${packages[@]}"}
}
