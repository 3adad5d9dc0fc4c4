# Captures side by side: make's job server starts them and keeps going where one fails. They are numbers here: names may hold anything.
.PHONY: all $(shell seq $(COUNT))
all: $(shell seq $(COUNT))
$(shell seq $(COUNT)):
	@"$$ONE" one "$$LIST" $@
