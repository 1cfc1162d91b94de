/* SPDX-License-Identifier: MIT */
/* For cppcheck, which does not read the headers of libraries: macros of jansson that look like no C without their definition. */
#define json_array_foreach(array, index, value) \
    for (index = 0; index < json_array_size(array) && (value = json_array_get(array, index)); index++)
#define json_object_foreach(object, key, value) \
    for (void *json_iterator = json_object_iter(object); \
         json_iterator && (key = json_object_iter_key(json_iterator)) && (value = json_object_iter_value(json_iterator)); \
         json_iterator = json_object_iter_next(object, json_iterator))
