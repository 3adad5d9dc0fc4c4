# A manual page from what --help prints: "NAME: ABOUT", paragraphs, "Usage: CALL", lines "  --option  text" with what belongs to them
# indented more, "Exit status: ...".
function roff(s) { gsub(/\\/, "\\e", s); gsub(/-/, "\\-", s); sub(/^[.']/, "\\\\\\&&", s); return s }
function put(s) { if (usage == "") { text = text s "\n"; return } if (gap) print ".PP"; gap = 0; print s }
function item(line,  at) {
	at = match(line, /  +/)
	gap = 0
	put(".TP\n.B " roff(at ? substr(line, 1, at - 1) : line))
	if (at) put(roff(substr(line, at + RLENGTH)))
}
NR == 1 {
	about = $0; sub(/^[a-z]+: /, "", about)
	printf ".TH %s 1 \"\" \"Eyewright %s\" \"Eyewright\"\n.SH NAME\n%s \\- %s\n", toupper(page), version, page, roff(about)
	next
}
/^Usage: / {
	usage = $0; sub(/^Usage: /, "", usage)
	program = page; sub(/^eyewright-/, "", program)
	printf ".SH SYNOPSIS\n.B %s\n.SH DESCRIPTION\n%s.SH OPTIONS\n", roff(usage), text ~ /[a-z]/ ? text : roff(about) ".\n"
	if (program != "eyewright") printf "The program is lib/eyewright/bin/%s; the command\n.B eyewright CAPTURE %s\nruns it after those that it needs.\n", program, program
	gap = 0
	next
}
/^Exit status: / { sub(/^Exit status: /, ""); gap = 0; put(".SH EXIT STATUS\n" roff($0)); next }
/^  [^ ]/ { item(substr($0, 3)); next }
/^$/ { if (usage == "" && text != "") text = text ".PP\n"; gap = usage != ""; next }
{ sub(/^ +/, ""); put(roff($0)) }
