"""A browser as window and camera: a page, and the server that exchanges pictures with it.

A further page, as a desk or a questionnaire, is a `page.document` of files of its own, and answers
at paths of its own; `WebServer` takes both as `documents` and `routes`.
"""
