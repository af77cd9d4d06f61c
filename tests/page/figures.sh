#!/usr/bin/env bash
# Runs one scene of the gallery (the program is the first argument) with two contenders, and reads the figures that it writes as JSON.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
echo '<!-- pintle: runs -->' >"$folder/form.html"
"$1" "$folder/page.html" --template "$folder/form.html" --scene chain --contender stock --contender exact --json "$folder/figures.json"
cat "$folder/figures.json"
[ "$(head -c 1 "$folder/figures.json")$(tail -n 1 "$folder/figures.json")" = '[]' ]
# Of stock with 10 and 50 iterations, and of exact.
for who in 'stock' 'stock, 50 iterations' 'exact'; do
  [ "$(grep -cE "^\{\"precision\": \"double\", \"scene\": \"chain\", \"who\": \"$who\", \"quantity\": \"gap, mean of the worst\", \"unit\": \"m\", \"value\": [0-9.e+-]+\},?$" "$folder/figures.json")" = 1 ]
done
