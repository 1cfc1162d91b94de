// SPDX-License-Identifier: MIT
export function setVisible() {}
export function showWords() {}
export function begin() {}
