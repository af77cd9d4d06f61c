# Sourced: npm's packages of a folder's package.json, as its lock file says, into another one. Those that are there are kept.
pintle_npm_ci() {  # from, to
  cmp -s "$1/package-lock.json" "$2/installed.json" && return
  mkdir -p "$2" && rm -f "$2/installed.json" && cp "$1/package.json" "$1/package-lock.json" "$2/" &&
    (cd "$2" && npm ci --ignore-scripts --no-audit --no-fund --loglevel=error) &&
    cp "$1/package-lock.json" "$2/installed.json"
}
