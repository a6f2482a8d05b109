# Doxygen's filter: a line of a comment that is set in by four spaces is an equation, not a part of
# the paragraph before it (in a list it goes on with the item).
{
  comment = /^ *\/\/\// && !/^ *\/\/\/ *$/
  if (!comment) list = 0
  if (/^ *\/\/\/ *(-|[0-9]+\.) /) list = 1
  equation = !list && /^ *\/\/\/     +[^ ]/
  if (equation != was && comment) print "///"
  was = equation
  print
}
