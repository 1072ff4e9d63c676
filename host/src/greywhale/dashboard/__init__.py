"""The page's server: one board shared among pages, the verbs as jobs, and the bench's hands.

Another page or program gets the token by ``greywhale dashboard --json`` and sends it as the header
``X-Greywhale-Token``. A WebSocket offers the subprotocols ``greywhale`` and ``token.TOKEN``. The paths:

``/board`` (WebSocket)
    binary: whole frames of the link, both ways, samples of up to 20 ms at once. Text, from the server: ``page``
    (``id``), ``link`` (``open``, ``port``, ``sentence``), ``driver`` (``you``, ``free``, ``job``, ``verb``),
    ``stored`` (``crc`` of the set, or null), ``refused`` (``sentence``, and ``seq`` and ``type`` of the
    request), ``stopped`` (``sentence``: somebody else stopped the arm). Text, to it: ``drive``, ``release``,
    ``here``. Each is an object with the word as ``kind``. A request has the next number (``seq``), and what is
    repeated the same
``POST /enter``
    the token, for the ticket in the header ``X-Greywhale-Ticket``; without a token, a 403 says what to do
``GET /history?from=TICK``
    the frames of the samples kept, oldest first; from a tick on, since the board last started
``GET /state``
    version, port, arm, folder and its files with their kinds, sizes and dates (s since 1970), what comes with
    greywhale
``GET /file?name=``, ``DELETE /file?name=``, ``POST /file``
    the content of a file of the folder; deletes it; gives ``name`` the name ``to``
``PUT /file?name=&if_there=``
    brings a file, whole or not at all; where one of that name is, ``refuse`` (without a word), ``replace`` or
    ``rename``; the ``name`` it got
``POST /questions``
    the questions of ``arm new`` that follow from ``answers``: an object, or the name of a file of answers
``GET /arm?file=``
    the arm's URDF, and the stops of its joints
``GET /controller?file=``
    the raw values of a controller or parameter file
``GET /log?file=``
    the samples of a log of the folder, at most 600,000: payloads of the link's ``sample``, ticks from the log's
    first row
``POST /predict``
    ``raw`` (all parameters), ``board``, ``file`` (an arm or a model; the dashboard's arm without one): a step
    and a reach that the model predicts, in some 10 ms
``GET /calibrations``, ``POST /calibrations``
    the calibrations that the board at the port has had; keeps that of a set which a page read or gave
``GET /jobs``, ``POST /jobs``
    the verbs with their arguments, and the jobs so far; starts ``verb`` with ``arguments`` for the page of the
    header ``X-Greywhale-Page``
``DELETE /jobs/ID``, ``POST /jobs/ID``, ``DELETE /jobs/ID/card``
    Ctrl-C; a ``line`` for a verb that reads its standard input; forgets a job that has ended
``/host`` (WebSocket)
    each job, whenever it changes (``kind`` is ``job``, or ``gone`` where it was put away): ``state``,
    ``progress``, ``countdown`` (seconds until the arm moves, 0: not counted), ``telling`` (the result for
    people: the sentences and tables that a terminal prints, logs to draw, steps that come next), ``result``,
    ``error``, ``said``
``/torque?file=&filter_shift=`` (WebSocket)
    by a model.toml and the board's parameter, 25 times a second: ``joints`` (``torque_nm``, ``half_width_nm``,
    ``why`` it cannot be told or "", ``contact``, ``share`` of the stall torque) and the last ``contact``
    (``joint``, ``tick``, ``torque_nm`` at most, ``lasted_s``, ``lasts``), or null; or one ``error``
``GET /bench``, ``POST /bench``
    with ``--sim``: what can be changed, between which ends; changes ``leader``, ``motion``, ``fault``,
    ``power``, ``estop``, ``clutch``, ``supply``, ``load`` or ``speed``; while a page drives, for that page of
    the header ``X-Greywhale-Page`` alone
"""
