# What Doxygen reads in the place of a page: headings have the anchors that GitHub gives them, after the page's name, and links
# lead to them. What is linked and is no page of the site is named only.
function slug(text) {
  text = tolower(text)
  gsub(/[^a-z0-9_ -]/, "", text)
  gsub(/ /, "-", text)
  return text
}
# The name of a page by its file.
function page(file) {
  sub(/.*\//, "", file)
  sub(/\.md$/, "", file)
  return tolower(file)
}
function target(link, hash) {
  if (link ~ /:\/\//) return link
  hash = index(link, "#")
  if (hash == 1) return "@ref " page(FILENAME) "_" substr(link, 2)
  if (hash > 1) return "@ref " page(substr(link, 1, hash - 1)) "_" substr(link, hash + 1)
  return link ~ /\.md$/ && link !~ /results/ ? "@ref page_" page(link) : ""
}
/^```/ { fenced = !fenced }
fenced { print; next }
/^#/ {
  text = $0
  sub(/^#+ /, "", text)
  print $0 " {#" ($0 ~ /^# / ? "page_" page(FILENAME) : page(FILENAME) "_" slug(text)) "}"
  next
}
{
  line = $0
  out = ""
  while (match(line, /!?\[[^]]*\]\([^)]*\)/)) {
    whole = substr(line, RSTART, RLENGTH)
    before = substr(line, 1, RSTART - 1)
    line = substr(line, RSTART + RLENGTH)
    split(whole, part, /\]\(/)
    link = substr(part[2], 1, length(part[2]) - 1)
    text = part[1]
    if (text ~ /^!/) {
      sub(/.*\//, "", link)
      out = out before text "](" link ")"
    } else {
      to = target(link)
      if (to ~ /^@ref/) gsub(/`/, "", text)  # would be shown
      out = out before (to == "" ? substr(text, 2) : text "](" to ")")
    }
  }
  print out line
}
