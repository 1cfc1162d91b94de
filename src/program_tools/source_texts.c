/* SPDX-License-Identifier: MIT */
#include "source_texts.h"

#include <stdlib.h>
#include <string.h>

#include "text/text.h"

void source_texts_free(char **texts, size_t count)
{
    for (size_t i = 0; texts != NULL && i < count; i++)
        free(texts[i]);
    free(texts);
}

static char *map_text(const struct program_source *source)
{
    char *text = malloc(source->length + 1);
    if (text == NULL)
        return NULL;
    if (source->length > 0)
        memcpy(text, source->text, source->length);
    program_text_map_in_place(text, source->length);
    return text;
}

char **source_texts_map(const struct program_source *sources, size_t count)
{
    char **texts = calloc(count + 1, sizeof *texts);
    for (size_t i = 0; texts != NULL && i < count; i++) {
        texts[i] = map_text(&sources[i]);
        if (texts[i] == NULL) {
            source_texts_free(texts, count);
            return NULL;
        }
    }
    return texts;
}
