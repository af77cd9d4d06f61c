# Sourced by demos/run.sh, which has `build` and tests/setup.sh, in the project's folder.

# The gallery as one file. Where there is no Node, and none can be had, all else has run.
make_page() {  # options of the gallery
  local page=build/pintle.html form=build/release/page/pintle_page.html
  pintle_install_page_packages
  rm -f "$page"
  build pintle_page pintle_gallery_double
  if [ -f "$form" ]; then
    build/release/demos/pintle_gallery_double "$page" --template "$form" "$@"
    [ ! -f "$page" ] || echo "$page plays the scenes side by side: open it in a browser."
  else
    echo "No page was made: it needs Node and npm (Debian: nodejs, npm). All else has run."
  fi
}
