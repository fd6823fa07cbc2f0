// SPDX-License-Identifier: Apache-2.0

export const capitalized = (text: string) => text.charAt(0).toUpperCase() + text.slice(1);
